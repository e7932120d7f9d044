// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose2_gaussian.hpp"

#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

#include "core/geometry/angle.hpp"

namespace strata {

Eigen::Matrix3d pose_covariance(double stddev_m, double stddev_rad) {
  return Eigen::Vector3d(stddev_m * stddev_m, stddev_m * stddev_m, stddev_rad * stddev_rad)
      .asDiagonal();
}

Pose2Gaussian operator*(const Pose2Gaussian& a_from_b, const Pose2Gaussian& b_from_c) {
  const Eigen::Matrix3d left = compose_jacobian_left(a_from_b.mean, b_from_c.mean);
  const Eigen::Matrix3d right = compose_jacobian_right(a_from_b.mean, b_from_c.mean);
  return {a_from_b.mean * b_from_c.mean, left * a_from_b.covariance * left.transpose() +
                                             right * b_from_c.covariance * right.transpose()};
}

Pose2Gaussian inverse(const Pose2Gaussian& a_from_b) {
  const Pose2& m = a_from_b.mean;
  const double c = std::cos(m.theta);
  const double s = std::sin(m.theta);
  Eigen::Matrix3d jacobian;
  jacobian << -c, -s, s * m.x - c * m.y,  //
      s, -c, c * m.x + s * m.y,           //
      0.0, 0.0, -1.0;
  return {inverse(m), jacobian * a_from_b.covariance * jacobian.transpose()};
}

double mahalanobis_squared(const Pose2Gaussian& gaussian, const Pose2& pose) {
  const Eigen::Vector3d difference(pose.x - gaussian.mean.x, pose.y - gaussian.mean.y,
                                   angle_difference(pose.theta, gaussian.mean.theta));
  return difference.dot(gaussian.covariance.llt().solve(difference));
}

Pose2Gaussian weighted_gaussian(std::span<const Pose2> poses, std::span<const double> weights) {
  double sum = 0.0;
  double x = 0.0;
  double y = 0.0;
  double c = 0.0;
  double s = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum += weights[i];
    x += weights[i] * poses[i].x;
    y += weights[i] * poses[i].y;
    c += weights[i] * std::cos(poses[i].theta);
    s += weights[i] * std::sin(poses[i].theta);
  }
  Pose2Gaussian result;
  result.mean = {x / sum, y / sum, std::atan2(s, c)};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Vector3d d(poses[i].x - result.mean.x, poses[i].y - result.mean.y,
                            angle_difference(poses[i].theta, result.mean.theta));
    result.covariance += (weights[i] / sum) * d * d.transpose();
  }
  return result;
}

}  // namespace strata
