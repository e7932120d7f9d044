// SPDX-License-Identifier: Apache-2.0
/// How widely the particles of a pose are spread.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/pose2_gaussian.hpp"

namespace strata::localization {

/// Of both axes together [m].
[[nodiscard]] inline double position_stddev(const Pose2Gaussian& pose) {
  return std::sqrt(std::max(0.0, pose.covariance(0, 0) + pose.covariance(1, 1)));
}

/// Whether the particles agree on one place: also on the heading there, since in a room that looks
/// the same when turned round both places may be close. max_m: of the position's spread.
[[nodiscard]] inline bool is_one_place(const Pose2Gaussian& pose, double max_m) {
  constexpr double kMax_rad = 0.5;
  return position_stddev(pose) <= max_m && pose.covariance(2, 2) <= kMax_rad * kMax_rad;
}

}  // namespace strata::localization
