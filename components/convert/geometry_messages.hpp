// SPDX-License-Identifier: Apache-2.0
/// Stamps, poses and transforms. A heading travels as a quaternion and comes back to within 1e-15.
#pragma once

#include <string>

#include "strata_idl/builtin_interfaces.h"
#include "strata_idl/geometry_msgs.h"
#include "strata_idl/nav_msgs.h"
#include "strata_idl/strata_msgs.h"

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/geometry/pose3.hpp"

namespace strata::convert {

/// ROS 2 keeps 0 <= nanosec < 1e9, also before 1970.
[[nodiscard]] builtin_interfaces::msg::Time to_message(Stamp stamp);
[[nodiscard]] Stamp from_message(const builtin_interfaces::msg::Time& time);
[[nodiscard]] std_msgs::msg::Header make_header(Stamp stamp, const std::string& frame);

[[nodiscard]] geometry_msgs::msg::Pose to_pose(const Pose2& pose);
[[nodiscard]] geometry_msgs::msg::Transform to_transform(const Pose2& pose);
[[nodiscard]] geometry_msgs::msg::Transform to_transform(const Pose3& pose);
[[nodiscard]] Pose3 from_message(const geometry_msgs::msg::Pose& pose);
[[nodiscard]] Pose3 from_message(const geometry_msgs::msg::Transform& transform);

/// strata_msgs/Pose2 carries the very bits.
[[nodiscard]] strata_msgs::msg::Pose2 to_message(const Pose2& pose);
[[nodiscard]] Pose2 from_message(const strata_msgs::msg::Pose2& pose);
[[nodiscard]] strata_msgs::msg::Pose2Gaussian to_message(const Pose2Gaussian& gaussian);
[[nodiscard]] Pose2Gaussian from_message(const strata_msgs::msg::Pose2Gaussian& gaussian);

/// 6 x 6 covariance of ROS (x, y, z, roll, pitch, yaw), row by row; what the plane does not have
/// is 0.
[[nodiscard]] geometry_msgs::msg::PoseWithCovariance to_pose_with_covariance(
    const Pose2Gaussian& gaussian);
[[nodiscard]] Pose2Gaussian from_message(const geometry_msgs::msg::PoseWithCovariance& pose);

[[nodiscard]] nav_msgs::msg::Odometry to_odometry(Stamp stamp, const Pose2& odom_from_robot,
                                                  const std::string& odom_frame,
                                                  const std::string& robot_frame);
[[nodiscard]] geometry_msgs::msg::TransformStamped to_transform_stamped(
    Stamp stamp, const Pose2& parent_from_child, const std::string& parent,
    const std::string& child);
[[nodiscard]] geometry_msgs::msg::TransformStamped to_transform_stamped(
    Stamp stamp, const Pose3& parent_from_child, const std::string& parent,
    const std::string& child);

}  // namespace strata::convert
