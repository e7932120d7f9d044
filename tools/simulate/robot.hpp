// SPDX-License-Identifier: Apache-2.0
/// How the robot drives, and what its wheels tell of it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::simulate {

/// Integration step of the drive.
inline constexpr double kDriveStep_s = 0.02;

/// The true poses of one day at every drive step, from `start` through the route `laps` times.
/// Stops after a generous time when a waypoint cannot be reached.
[[nodiscard]] std::vector<Pose2> drive(const RobotConfig& config, const Pose2& start);

/// Where the first day begins: at the first waypoint, facing the second.
[[nodiscard]] Pose2 first_pose(const RobotConfig& config);

/// The odometry along true poses, from `start` in the odometry frame: each step's distance and turn
/// scaled by the day's errors, with noise whose variance grows with distance and turn.
[[nodiscard]] std::vector<Pose2> odometry(const RobotConfig& config,
                                          const std::vector<Pose2>& true_poses, const Pose2& start,
                                          std::uint64_t seed, int day);

}  // namespace strata::simulate
