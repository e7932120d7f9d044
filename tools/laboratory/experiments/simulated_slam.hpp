// SPDX-License-Identifier: Apache-2.0
/// SLAM on a simulated drive, against the simulator's truth.
#pragma once

#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/slam/slam.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {

/// SLAM over the first day. Throws Error when it leaves out a scan.
[[nodiscard]] slam::SlamResult learn_first_day(const simulate::Simulation& simulation,
                                               const slam::SlamConfig& config = {});

/// map_from_robot of each scan as SLAM found it; of the first day in truth.
[[nodiscard]] std::vector<Pose2> found_poses(const slam::SlamResult& result);
[[nodiscard]] std::vector<Pose2> true_poses(const simulate::Simulation& simulation);

/// Mean distance of the poses from the true ones [m], after one rigid alignment. As many of each.
[[nodiscard]] double aligned_error_m(const std::vector<Pose2>& poses,
                                     const std::vector<Pose2>& truth);

}  // namespace strata::experiments
