// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/odometry_noise.hpp"

#include <cmath>

namespace strata {

Pose2Gaussian odometry_step(const Pose2& from_from_to, double path_length_m,
                            const OdometryNoiseConfig& config) {
  const double sigma_m = config.floor_m + config.per_metre_m * path_length_m;
  const double sigma_rad = config.floor_rad + config.per_metre_rad * path_length_m +
                           config.per_radian_rad * std::abs(from_from_to.theta);
  return {from_from_to, pose_covariance(sigma_m, sigma_rad)};
}

bool is_possible(const Pose2& step, double time_s, const OdometryLimits& limits) {
  return std::hypot(step.x, step.y) <= limits.slack_m + limits.speed_mps * time_s &&
         std::abs(step.theta) <= limits.slack_rad + limits.turn_rps * time_s;
}

}  // namespace strata
