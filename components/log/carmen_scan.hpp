// SPDX-License-Identifier: Apache-2.0
/// What the lines of a CARMEN log leave open and only the log as a whole tells: which readings mean
/// that nothing came back, and where the laser sits.
#pragma once

#include <optional>
#include <vector>

#include "components/log/log_reader.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"

namespace strata::log {

constexpr float kSickMaximum = 80.0F;  ///< m, of the mode that logs were recorded in

/// A scan as its line has it.
struct CarmenScan {
  Observation observation;
  Pose2 laser_pose;
  bool states_maximum = false;  ///< ROBOTLASER1
};

/// Sets range_max and turns readings at or above it into +Inf: what settle_no_returns finds, else
/// 80 m of FLASER and what ROBOTLASER1 states. O(beams).
void mark_no_returns(std::vector<CarmenScan>& scans, const ReadOptions& options,
                     ReadReport& report);

/// Sets robot_from_laser: the median difference of laser and odometry poses, or, where most scans
/// differ from it (a corrected log), PARAM robot_frontlaser_offset. scans: at least one.
void find_mounting(std::vector<CarmenScan>& scans, std::optional<double> front_laser_offset,
                   ReadReport& report);

}  // namespace strata::log
