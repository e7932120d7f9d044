// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/odometry_noise.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace strata {
namespace {

TEST(OdometryStep, GrowsByTheWayDrivenAndTheNetTurn) {
  const OdometryNoiseConfig config{.floor_m = 0.1,
                                   .per_metre_m = 0.2,
                                   .floor_rad = 0.01,
                                   .per_metre_rad = 0.02,
                                   .per_radian_rad = 0.5};
  const Pose2 step{1.0, 2.0, -0.4};
  const Pose2Gaussian gaussian = odometry_step(step, 3.0, config);
  EXPECT_EQ(gaussian.mean, step);
  const Eigen::Vector3d expected(0.7 * 0.7, 0.7 * 0.7, 0.27 * 0.27);
  EXPECT_LT((gaussian.covariance - Eigen::Matrix3d(expected.asDiagonal())).norm(), 1e-12);
}

}  // namespace
}  // namespace strata
