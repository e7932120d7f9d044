// SPDX-License-Identifier: Apache-2.0
#include "components/log/robot_frames.hpp"

#include <cmath>

#include "components/convert/geometry_messages.hpp"

namespace strata::log {

Pose2 moved_by(const Pose2& odom_from_child, const Pose2& child_from_robot) {
  return child_from_robot == Pose2{} ? odom_from_child : odom_from_child * child_from_robot;
}

std::string missing_mounting(const std::string& sensor_frame, const std::string& robot_frame) {
  return "tf_static does not connect " + sensor_frame + " to " + robot_frame +
         "; the laser is taken to sit at its origin";
}

bool is_sound(const Pose3& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
         pose.rotation.squaredNorm() > 0.0;
}

bool RobotFrames::add_fixed(const geometry_msgs::msg::TransformStamped& transform) {
  const Pose3 pose = convert::from_message(transform.transform());
  if (!is_sound(pose)) return false;
  fixed_.add(transform.header().frame_id(), transform.child_frame_id(), pose);
  all_.add(transform.header().frame_id(), transform.child_frame_id(), pose);
  return true;
}

bool RobotFrames::add_moving(const geometry_msgs::msg::TransformStamped& transform) {
  const Pose3 pose = convert::from_message(transform.transform());
  if (!is_sound(pose)) return false;
  all_.add(transform.header().frame_id(), transform.child_frame_id(), pose);
  return true;
}

bool RobotFrames::is_robots(const std::string& frame) const {
  return frame.empty() || frame == robot_ || all_.find(frame, robot_).has_value();
}

Pose2 RobotFrames::robot_in(const std::string& child) const {
  if (child.empty() || child == robot_) return Pose2{};
  const auto child_from_robot = all_.find(child, robot_);
  return child_from_robot ? planar(*child_from_robot) : Pose2{};
}

std::string RobotFrames::pose_frame(const std::string& odometry_child) const {
  return is_robots(odometry_child) ? robot_ : odometry_child;
}

std::optional<Pose3> RobotFrames::mounting(const std::string& sensor_frame,
                                           const std::string& odometry_child) const {
  if (const auto found = fixed_.find(robot_, sensor_frame)) return found;
  if (is_robots(odometry_child)) return std::nullopt;
  return fixed_.find(odometry_child, sensor_frame);
}

}  // namespace strata::log
