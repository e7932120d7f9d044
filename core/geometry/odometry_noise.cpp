// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/odometry_noise.hpp"

#include <cmath>

namespace strata {

Pose2Gaussian odometry_step(const Pose2& from_from_to, double way_m,
                            const OdometryNoiseConfig& config) {
  const double sigma_m = config.floor_m + config.per_metre_m * way_m;
  const double sigma_rad = config.floor_rad + config.per_metre_rad * way_m +
                           config.per_radian_rad * std::abs(from_from_to.theta);
  Pose2Gaussian step{from_from_to, Eigen::Matrix3d::Zero()};
  step.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad;
  return step;
}

}  // namespace strata
