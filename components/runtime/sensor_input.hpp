// SPDX-License-Identifier: Apache-2.0
/// Joins what a robot publishes apart: scans, odometry and the laser's mounting.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/log/transform_tree.hpp"
#include "core/base/config.hpp"
#include "core/scan/scan.hpp"

namespace strata::runtime {

struct SensorInputConfig {
  std::string scan_topic = "scan";
  std::string odometry_topic = "odom";
  std::string tf_odometry_frame = "odom";
  std::string robot_frame = "base_link";
  bool use_odometry = true;
  int most_waiting_scans = 20;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("scan_topic", c.scan_topic, {.doc = "sensor_msgs/LaserScan in"});
    v.field("odometry_topic", c.odometry_topic, {.doc = "nav_msgs/Odometry in"});
    v.field("tf_odometry_frame", c.tf_odometry_frame,
            {.doc = "live, while nobody publishes odometry_topic: odometry is this frame to "
                    "robot_frame on /tf; empty: never"});
    v.field("robot_frame", c.robot_frame, {.doc = "frame that poses are of"});
    v.field("use_odometry", c.use_odometry, {.doc = "false: scans only"});
    v.field("most_waiting_scans", c.most_waiting_scans,
            {.doc = "a scan waits for odometry and mounting until so many have come after it",
             .unit = "scans",
             .min = 0.0});
  }
};

/// Odometry of a scan's very stamp is taken as it is, else it is interpolated. A scan waits until
/// odometry has reached its stamp and its mounting is known; when too many wait, the oldest goes
/// on without. Scans with time_increment are undistorted as the log readers do it (in lockstep the
/// player has).
class SensorInput {
 public:
  /// waits: false in lockstep, where everything that belongs to a scan came before it.
  SensorInput(SensorInputConfig config, bool waits) : config_(std::move(config)), waits_(waits) {}

  /// /tf_static.
  void add(const tf2_msgs::msg::TFMessage& transforms);
  /// /tf, for robots that give odometry there only. The first nav_msgs/Odometry ends that.
  void add_moving(const tf2_msgs::msg::TFMessage& transforms);
  void add(const nav_msgs::msg::Odometry& odometry);
  /// Throws InputError, and forgets the scan, when its angles or limits are not numbers.
  void add(const sensor_msgs::msg::LaserScan& scan);
  /// The scans that are complete now, in order.
  [[nodiscard]] std::vector<Observation> take();

 private:
  struct TimedPose {
    Stamp stamp;
    Pose2 pose;
  };
  void add_odometry(Stamp stamp, const Pose2& odom_from_robot);
  [[nodiscard]] std::optional<Pose2> find_mounting(const std::string& frame) const;
  [[nodiscard]] bool find_odometry(Stamp stamp, Pose2& pose) const;
  [[nodiscard]] bool is_complete(const sensor_msgs::msg::LaserScan& scan) const;
  [[nodiscard]] Observation make(const sensor_msgs::msg::LaserScan& scan) const;

  SensorInputConfig config_;
  bool waits_;
  log::TransformTree fixed_;
  log::TransformTree moving_;  // the fixed ones and those of /tf
  bool has_odometry_topic_ = false;
  std::deque<TimedPose> odometry_;
  std::deque<sensor_msgs::msg::LaserScan> scans_;
};

}  // namespace strata::runtime
