// SPDX-License-Identifier: Apache-2.0
/// Where a robot's sensors sit, and which of its frames odometry is of: for logs and live robots.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "strata_idl/geometry_msgs.h"

#include "components/log/transform_tree.hpp"
#include "core/geometry/pose2.hpp"
#include "core/geometry/pose3.hpp"

namespace strata::log {

class RobotFrames {
 public:
  explicit RobotFrames(const std::string& robot_frame = "base_link")
      : robot_(frame_name(robot_frame)) {}

  /// Of /tf_static; false when it is not finite, and then it is passed over. O(log frames).
  bool add_fixed(const geometry_msgs::msg::TransformStamped& transform);
  /// Of /tf, without what hangs on the odometry frame: taken to hold until the next one.
  bool add_moving(const geometry_msgs::msg::TransformStamped& transform);

  /// Whether tf connects the frame to the robot's. True for the robot's own and for no name at all.
  [[nodiscard]] bool is_robots(const std::string& frame) const;
  /// child_from_robot in the plane, for odometry of another frame of the robot, such as its
  /// footprint. A frame that is not connected to the robot's is taken for it.
  [[nodiscard]] Pose2 robot_in(const std::string& child) const;
  /// The frame that poses are of: the robot's, or that of its odometry where tf does not know the
  /// robot's.
  [[nodiscard]] std::string pose_frame(const std::string& odometry_child) const;
  /// robot_from_sensor by /tf_static, or where that does not connect them, by links of /tf that
  /// came again and never changed (by 0.5 mm or 0.001 rad at most), as mountings were published in
  /// ROS 1. Nothing when they are not connected. O(frames).
  [[nodiscard]] std::optional<Pose3> mounting(const std::string& sensor_frame,
                                              const std::string& odometry_child) const;
  /// For people, where `mounting` gives nothing: why, what is done about it, and, where tf knows
  /// the sensor but not the robot's frame, what to set.
  [[nodiscard]] std::string missing_mounting(const std::string& sensor_frame,
                                             const std::string& odometry_child) const;
  /// Whether `mounting` is by /tf_static alone.
  [[nodiscard]] bool is_fixed(const std::string& sensor_frame,
                              const std::string& odometry_child) const;

 private:
  /// A link of /tf.
  struct Link {
    std::string parent;
    Pose3 pose;
    bool has_moved = false;
  };
  [[nodiscard]] std::optional<Pose3> connected(const TransformTree& tree,
                                               const std::string& sensor_frame,
                                               const std::string& odometry_child) const;

  std::string robot_;
  TransformTree fixed_;
  TransformTree steady_;               ///< the fixed ones, and those of /tf that have not moved
  TransformTree all_;                  ///< the fixed ones and those of /tf
  std::map<std::string, Link> links_;  ///< by child
};

/// odom_from_robot of odom_from_child; to the bit where the two frames are one.
[[nodiscard]] Pose2 moved_by(const Pose2& odom_from_child, const Pose2& child_from_robot);

/// Whether a frame is one of odometry by its name: odom_combined, robot1/odom.
[[nodiscard]] bool names_odometry(const std::string& frame);

/// Whether all numbers are, and the rotation is one.
[[nodiscard]] bool is_sound(const Pose3& pose);

}  // namespace strata::log
