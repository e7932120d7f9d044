// SPDX-License-Identifier: Apache-2.0
#include "components/log/joined_scan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "components/convert/scan_messages.hpp"
#include "core/base/error.hpp"

namespace strata::log {

Scan scan_of(const sensor_msgs::msg::LaserScan& message, const std::string& place) {
  Scan scan = convert::from_message(message, Pose2{});
  if (!std::isfinite(scan.angle_min_rad) || !std::isfinite(scan.angle_increment_rad) ||
      !std::isfinite(scan.range_min_m) || std::isnan(scan.range_max_m)) {
    throw InputError(place, "a scan's angles or limits are not numbers", "see what publishes it");
  }
  if (!std::isfinite(scan.time_increment_s)) scan.time_increment_s = 0.0F;
  return scan;
}

bool is_blank(const Scan& scan) {
  return std::all_of(scan.ranges_m.begin(), scan.ranges_m.end(),
                     [](float range) { return std::isnan(range); });
}

void mount(Scan& scan, const Pose3& robot_from_laser) {
  scan.robot_from_laser = planar(robot_from_laser);
  if (!is_upside_down(robot_from_laser)) return;
  const double last = scan.size() == 0 ? 0.0 : scan.bearing_rad(scan.size() - 1);
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  scan.angle_min_rad = static_cast<float>(-last);
}

std::optional<Observation> join(Scan scan, const OdometryAt& odometry, const SweepTiming& timing,
                                bool undistort) {
  Observation observation;
  observation.has_odometry = odometry != nullptr;
  const Stamp begin = scan.stamp - Duration::from_seconds(timing.delay_s);
  if (odometry) {
    const auto pose = odometry(begin);
    if (!pose) return std::nullopt;
    observation.odom_from_robot = *pose;
  }
  if (undistort) {
    const Duration sweep = sweep_duration(scan);
    const auto end = odometry && sweep.ns != 0 ? odometry(begin + sweep) : std::nullopt;
    if (end) {
      scan = strata::undistort(scan, between(observation.odom_from_robot, *end), timing.reversed);
    }
    scan.time_increment_s = 0.0F;
  }
  observation.scan = std::move(scan);
  return observation;
}

Stamp end_of_sweep(const Scan& scan) {
  return std::max(scan.stamp, scan.stamp + sweep_duration(scan));
}

}  // namespace strata::log
