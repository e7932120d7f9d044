// SPDX-License-Identifier: Apache-2.0
// What the parts of Tracker share; only its own .cpp files see it.
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose2_gaussian.hpp"
#include "core/slam/slam_config.hpp"

namespace strata::slam {

/// odometry_step with the standard deviation of its position times `doubt`.
[[nodiscard]] Pose2Gaussian doubted_step(const Pose2& step, const OdometryNoiseConfig& noise,
                                         double doubt);

/// Whether a scan of that information leaves its position open in some direction.
[[nodiscard]] bool is_ambiguous(const Eigen::Matrix3d& information);

/// A covariance of (x, y, theta) in axes turned by `turn`.
[[nodiscard]] Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Pose2& turn);

}  // namespace strata::slam
