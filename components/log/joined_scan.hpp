// SPDX-License-Identifier: Apache-2.0
/// A scan, its mounting and odometry made into one observation: the same for logs and live robots.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "strata_idl/sensor_msgs.h"
#include <Eigen/Core>

#include "core/geometry/pose3.hpp"
#include "core/scan/cloud_slice.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/undistort.hpp"

namespace strata::log {

/// odom_from_robot at a moment; nothing where odometry says nothing of it.
using OdometryAt = std::function<std::optional<Pose2>(Stamp)>;

/// What a scanner said at once.
struct SensedScan {
  std::string frame;
  /// Of a cloud only the stamp, until it is mounted.
  Scan scan;
  /// Of a cloud that tells times, in seconds after the stamp: of each point; of each beam once it
  /// is mounted.
  std::vector<float> offset_s;
  std::vector<Eigen::Vector3f> points_m;  ///< of a cloud that is not mounted yet
  bool is_cloud = false;
};

/// Without a mounting. Throws InputError (place) when the scan's angles or limits are not numbers,
/// when all beams point one way, or around more than twice, as angles in degrees seem to. A
/// time_increment that is none becomes 0. O(beams).
[[nodiscard]] SensedScan sensed(const sensor_msgs::msg::LaserScan& message,
                                const std::string& place);
/// For people, where angle_max says that the scan ends elsewhere than its beams do; else empty. One
/// beam more or less, and whole turns, are usual. An angle_max of 0, or of angle_min, says nothing.
[[nodiscard]] std::string doubt_angles(const sensor_msgs::msg::LaserScan& message);
/// Throws InputError for a cloud without sound x, y and z (convert::from_message). O(points).
[[nodiscard]] SensedScan sensed(const sensor_msgs::msg::PointCloud2& message);

/// Whether no beam has a reading: none at all, or NaN in every one.
[[nodiscard]] bool is_blank(const Scan& scan);

/// Puts the scan where its sensor sits; that of a laser upside down is turned round, so that its
/// beams run counter-clockwise again. Of a cloud the slice is cut. O(beams + points).
void mount(SensedScan& sensed, const Pose3& robot_from_sensor, const CloudSliceConfig& slice);

/// For people, where a laser's beams sweep a plane that is tilted against the robot's by more than
/// 5 degrees; else empty. `mount` takes them for level.
[[nodiscard]] std::string doubt_mounting(const std::string& frame, const Pose3& robot_from_laser);

/// The observation of a mounted scan, run 0. odometry: empty for none; else it has to know the
/// scan's moment, or there is no observation. undistort: a scan whose beams were taken one after
/// the other is corrected by odometry, where it reaches the sweep's end and was not reset within
/// the sweep, and has no time_increment afterwards. O(beams).
[[nodiscard]] std::optional<Observation> join(SensedScan sensed, const OdometryAt& odometry,
                                              const SweepTiming& timing, bool undistort);

/// When odometry has said all that `join` asks for. O(points of a cloud).
[[nodiscard]] Stamp end_of_sweep(const SensedScan& sensed);

}  // namespace strata::log
