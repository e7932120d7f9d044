// SPDX-License-Identifier: Apache-2.0
/// Gaussians over SE(2), parametrized by (x, y, theta) in the frame of the mean's parent, which is
/// how ROS's PoseWithCovariance states them.
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"

namespace strata {

/// mean a_from_b; covariance of (x [m], y [m], theta [rad]) in frame a, symmetric.
struct Pose2Gaussian {
  Pose2 mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Covariance of a pose known so well in every direction, and its heading for itself.
[[nodiscard]] Eigen::Matrix3d pose_covariance(double stddev_m, double stddev_rad);
/// a_from_c to first order, for independent a_from_b and b_from_c.
[[nodiscard]] Pose2Gaussian operator*(const Pose2Gaussian& a_from_b, const Pose2Gaussian& b_from_c);
/// b_from_a to first order.
[[nodiscard]] Pose2Gaussian inverse(const Pose2Gaussian& a_from_b);
/// Squared Mahalanobis distance of `pose` from the Gaussian, heading difference wrapped; needs a
/// positive definite covariance.
[[nodiscard]] double mahalanobis_squared(const Pose2Gaussian& gaussian, const Pose2& pose);
/// Weighted mean (circular in theta) and covariance of poses. Weights need not be normalized but
/// must have a positive sum; equal lengths. O(n).
[[nodiscard]] Pose2Gaussian weighted_gaussian(std::span<const Pose2> poses,
                                              std::span<const double> weights);

}  // namespace strata
