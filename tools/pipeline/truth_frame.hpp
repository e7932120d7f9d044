// SPDX-License-Identifier: Apache-2.0
/// Where the frame of the ground truth lies in the map.
#pragma once

#include <optional>
#include <span>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::pipeline {

/// A pose that learning gave a scan.
struct LearnedPose {
  int run = 0;
  Stamp stamp;
  Pose2 map_from_robot;
};

/// The rigid motion from the truth's frame to the maps', by all scans that have both; nothing when
/// none has. learned: in the order of the runs' observations, of which some may be missing.
[[nodiscard]] std::optional<Pose2> map_from_truth(const Runs& runs,
                                                  std::span<const LearnedPose> learned);

}  // namespace strata::pipeline
