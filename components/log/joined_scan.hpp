// SPDX-License-Identifier: Apache-2.0
/// A scan, its mounting and odometry made into one observation: the same for logs and live robots.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "strata_idl/sensor_msgs.h"

#include "core/geometry/pose3.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/undistort.hpp"

namespace strata::log {

/// odom_from_robot at a moment; nothing where odometry says nothing of it.
using OdometryAt = std::function<std::optional<Pose2>(Stamp)>;

/// The scan without a mounting. Throws InputError (place) when its angles or limits are not
/// numbers. A time_increment that is none becomes 0. O(beams).
[[nodiscard]] Scan scan_of(const sensor_msgs::msg::LaserScan& message, const std::string& place);

/// Whether no beam has a reading: none at all, or NaN in every one.
[[nodiscard]] bool is_blank(const Scan& scan);

/// Puts the scan where its laser sits; that of a laser upside down is turned round, so that its
/// beams run counter-clockwise again. O(beams).
void mount(Scan& scan, const Pose3& robot_from_laser);

/// The observation of a mounted scan, run 0. odometry: empty for none; else it has to know the
/// scan's moment, or there is no observation. undistort: a scan with time_increment is corrected by
/// odometry, where it reaches the sweep's end, and has none afterwards. O(beams).
[[nodiscard]] std::optional<Observation> join(Scan scan, const OdometryAt& odometry,
                                              const SweepTiming& timing, bool undistort);

/// When odometry has said all that `join` asks for.
[[nodiscard]] Stamp end_of_sweep(const Scan& scan);

}  // namespace strata::log
