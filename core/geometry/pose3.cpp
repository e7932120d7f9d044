// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose3.hpp"

#include <cmath>

#include "core/geometry/angle.hpp"

namespace strata {

Pose3 operator*(const Pose3& a_from_b, const Pose3& b_from_c) {
  return {a_from_b.translation + a_from_b.rotation * b_from_c.translation,
          (a_from_b.rotation * b_from_c.rotation).normalized()};
}

Eigen::Vector3d operator*(const Pose3& a_from_b, const Eigen::Vector3d& point_in_b) {
  return a_from_b.translation + a_from_b.rotation * point_in_b;
}

Pose3 inverse(const Pose3& a_from_b) {
  const Eigen::Quaterniond back = a_from_b.rotation.conjugate();
  return {-(back * a_from_b.translation), back};
}

Pose2 planar(const Pose3& pose) {
  return {pose.translation.x(), pose.translation.y(), heading_of(pose.rotation)};
}

Pose3 lift(const Pose2& pose) {
  return {Eigen::Vector3d(pose.x, pose.y, 0.0), rotation_about_z(pose.theta)};
}

bool is_upside_down(const Pose3& a_from_b) {
  return (a_from_b.rotation * Eigen::Vector3d::UnitZ()).z() < 0.0;
}

Eigen::Quaterniond rotation_about_z(double theta_rad) {
  return {std::cos(0.5 * theta_rad), 0.0, 0.0, std::sin(0.5 * theta_rad)};
}

double heading_of(const Eigen::Quaterniond& rotation) {
  // In the plane the half angle is there to the last bit, which the rotated axis loses near 90
  // degrees; a heading that was written as a quaternion must read back as the same bits.
  if (rotation.x() == 0.0 && rotation.y() == 0.0) {
    return wrap_angle(2.0 * std::atan2(rotation.z(), rotation.w()));
  }
  const Eigen::Vector3d x_axis = rotation * Eigen::Vector3d::UnitX();
  return std::atan2(x_axis.y(), x_axis.x());
}

}  // namespace strata
