// SPDX-License-Identifier: Apache-2.0
/// A recorded log as the messages a robot would publish, scan by scan.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/rosgraph_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/strata_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/log/log_reader.hpp"
#include "core/scan/scan.hpp"

namespace strata::player {

/// Where the messages go.
struct Outputs {
  std::function<void(const rosgraph_msgs::msg::Clock&)> clock;
  std::function<void(const tf2_msgs::msg::TFMessage&)> tf_static;
  std::function<void(const tf2_msgs::msg::TFMessage&)> tf;
  std::function<void(const nav_msgs::msg::Odometry&)> odometry;
  std::function<void(const sensor_msgs::msg::LaserScan&)> scan;
  /// May be empty. The run of each scan and, where known, its pose (else NaN).
  std::function<void(const strata_msgs::msg::ScanPose&)> given_pose;
};

/// What the frames of the messages are called.
struct FrameNames {
  std::string robot = "base_link";
  std::string odometry = "odom";
  std::string laser = "laser";
  std::vector<log::ScannerFrame> scanners = {};  ///< those of a mounting that is not here: `laser`
};

/// Publishes observations in those frames; of several scanners without names the others have the
/// frames laser_1, laser_2 and so on, a mounting each. What a component puts together from the
/// messages is the observation with the same bits.
class LogPlayer {
 public:
  /// given_poses: map_from_robot of each observation where known, or empty.
  LogPlayer(std::vector<Observation> observations, Outputs outputs,
            std::vector<std::optional<Pose2>> given_poses = {}, FrameNames frames = {});
  [[nodiscard]] const std::vector<Observation>& observations() const { return observations_; }
  /// Clock, tf_static (first and when another mounting comes), tf, odometry and the given pose,
  /// then the scan.
  void publish(std::size_t index);

 private:
  /// The frame of the scan's laser, which tf_static knows by then.
  std::string frame_of(const Scan& scan);
  [[nodiscard]] std::string name_of(const Pose2& mounting) const;
  std::vector<Observation> observations_;
  Outputs outputs_;
  std::vector<std::optional<Pose2>> given_poses_;
  FrameNames frames_;
  std::vector<log::ScannerFrame> seen_;  ///< so far
};

}  // namespace strata::player
