// SPDX-License-Identifier: Apache-2.0
/// Rigid motions of space, SE(3), as tf carries them, and their shadow in the plane.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/pose2.hpp"

namespace strata {

/// a_from_b: translation in metres, rotation as a unit quaternion.
struct Pose3 {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

[[nodiscard]] Pose3 operator*(const Pose3& a_from_b, const Pose3& b_from_c);
[[nodiscard]] Eigen::Vector3d operator*(const Pose3& a_from_b, const Eigen::Vector3d& point_in_b);
[[nodiscard]] Pose3 inverse(const Pose3& a_from_b);

/// The planar part: x, y and the heading of b's x axis seen from above. A sensor mounted upside
/// down loses its mirror image here; see is_upside_down.
[[nodiscard]] Pose2 planar(const Pose3& pose);
/// z = 0, no roll or pitch.
[[nodiscard]] Pose3 lift(const Pose2& pose);
/// Whether b's z axis points below the horizon of a.
[[nodiscard]] bool is_upside_down(const Pose3& a_from_b);
/// The unit quaternion of a heading.
[[nodiscard]] Eigen::Quaterniond rotation_about_z(double theta_rad);
/// The heading of the x axis of a rotation, in (-pi, pi].
[[nodiscard]] double heading_of(const Eigen::Quaterniond& rotation);

}  // namespace strata
