// SPDX-License-Identifier: Apache-2.0
#include "components/log/robot_frames.hpp"

#include <algorithm>
#include <cmath>

#include "components/convert/geometry_messages.hpp"

namespace strata::log {
namespace {

/// But for what no scan can show: the last digits of who computes the transform anew, the steps of
/// a servo that holds a scanner.
bool is_same(const Pose3& a, const Pose3& b) {
  constexpr double kTolerance = 5e-4;  // m, and parts of a quaternion: 0.001 rad
  const auto& p = a.rotation.coeffs();
  const auto& q = b.rotation.coeffs();
  return (a.translation - b.translation).norm() < kTolerance &&
         std::min((p - q).norm(), (p + q).norm()) < kTolerance;
}

}  // namespace

Pose2 moved_by(const Pose2& odom_from_child, const Pose2& child_from_robot) {
  return child_from_robot == Pose2{} ? odom_from_child : odom_from_child * child_from_robot;
}

bool names_odometry(const std::string& frame) {
  return frame.substr(frame.rfind('/') + 1).starts_with("odom");  // npos + 1 is 0
}

bool is_sound(const Pose3& pose) {
  return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
         pose.rotation.squaredNorm() > 0.0;
}

bool RobotFrames::add_fixed(const geometry_msgs::msg::TransformStamped& transform) {
  const Pose3 pose = convert::from_message(transform.transform());
  if (!is_sound(pose)) return false;
  fixed_.add(transform.header().frame_id(), transform.child_frame_id(), pose);
  steady_.add(transform.header().frame_id(), transform.child_frame_id(), pose);
  all_.add(transform.header().frame_id(), transform.child_frame_id(), pose);
  return true;
}

bool RobotFrames::add_moving(const geometry_msgs::msg::TransformStamped& transform) {
  const Pose3 pose = convert::from_message(transform.transform());
  if (!is_sound(pose)) return false;
  const std::string parent = frame_name(transform.header().frame_id());
  const std::string child = frame_name(transform.child_frame_id());
  all_.add(parent, child, pose);
  const auto [link, is_new] = links_.try_emplace(child, Link{parent, pose});
  if (is_new || link->second.has_moved) return true;
  if (link->second.parent == parent && is_same(link->second.pose, pose)) {
    steady_.add(parent, child, pose);
  } else {
    link->second.has_moved = true;
    steady_.remove(child);
  }
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
  const auto fixed = connected(fixed_, sensor_frame, odometry_child);
  return fixed ? fixed : connected(steady_, sensor_frame, odometry_child);
}

std::string RobotFrames::missing_mounting(const std::string& sensor_frame,
                                          const std::string& odometry_child) const {
  const std::string robot = pose_frame(odometry_child);
  const bool moves = connected(all_, sensor_frame, odometry_child).has_value();
  const std::string root = fixed_.root_of(sensor_frame);
  const bool has_other_root = !moves && root != sensor_frame && !all_.knows(robot);
  return (moves ? sensor_frame + " moves against " + robot + ", as /tf tells"
                : "tf_static does not connect " + sensor_frame + " to " + robot) +
         "; the laser is taken to sit at its origin" +
         (has_other_root ? ". It hangs on " + root + ": set robot_frame to the robot's frame" : "");
}

bool RobotFrames::is_fixed(const std::string& sensor_frame,
                           const std::string& odometry_child) const {
  return connected(fixed_, sensor_frame, odometry_child).has_value();
}

std::optional<Pose3> RobotFrames::connected(const TransformTree& tree,
                                            const std::string& sensor_frame,
                                            const std::string& odometry_child) const {
  if (const auto found = tree.find(robot_, sensor_frame)) return found;
  if (is_robots(odometry_child)) return std::nullopt;
  return tree.find(odometry_child, sensor_frame);
}

}  // namespace strata::log
