// SPDX-License-Identifier: Apache-2.0
#include "memory/store/detail/scan_header.hpp"

namespace strata::memory::detail {

ScanHeader header_of(const PosedScan& posed, std::uint32_t more) {
  const Scan& scan = posed.scan;
  const Pose2& pose = posed.map_from_robot;
  const Pose2& laser = scan.robot_from_laser;
  return {scan.stamp.ns,
          {pose.x, pose.y, pose.theta},
          {laser.x, laser.y, laser.theta},
          scan.angle_min_rad,
          scan.angle_increment_rad,
          scan.time_increment_s,
          scan.scan_time_s,
          scan.range_min_m,
          scan.range_max_m,
          static_cast<std::uint32_t>(scan.ranges_m.size()),
          more};
}

PosedScan scan_of(const ScanHeader& header, int run) {
  PosedScan posed;
  posed.run = run;
  posed.map_from_robot = {header.map_from_robot[0], header.map_from_robot[1],
                          header.map_from_robot[2]};
  Scan& scan = posed.scan;
  scan.stamp = {header.stamp_ns};
  scan.robot_from_laser = {header.robot_from_laser[0], header.robot_from_laser[1],
                           header.robot_from_laser[2]};
  scan.angle_min_rad = header.angle_min_rad;
  scan.angle_increment_rad = header.angle_increment_rad;
  scan.time_increment_s = header.time_increment_s;
  scan.scan_time_s = header.scan_time_s;
  scan.range_min_m = header.range_min_m;
  scan.range_max_m = header.range_max_m;
  scan.ranges_m.resize(header.ranges);
  return posed;
}

}  // namespace strata::memory::detail
