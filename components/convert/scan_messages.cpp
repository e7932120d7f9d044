// SPDX-License-Identifier: Apache-2.0
#include "components/convert/scan_messages.hpp"

#include "components/convert/geometry_messages.hpp"

namespace strata::convert {

sensor_msgs::msg::LaserScan to_message(const Scan& scan, const std::string& frame) {
  sensor_msgs::msg::LaserScan message;
  message.header(make_header(scan.stamp, frame));
  message.angle_min(scan.angle_min_rad);
  message.angle_increment(scan.angle_increment_rad);
  message.angle_max(scan.size() == 0 ? scan.angle_min_rad
                                     : static_cast<float>(scan.bearing_rad(scan.size() - 1)));
  message.time_increment(scan.time_increment_s);
  message.scan_time(scan.scan_time_s);
  message.range_min(scan.range_min_m);
  message.range_max(scan.range_max_m);
  message.ranges(scan.ranges_m);
  return message;
}

Scan from_message(const sensor_msgs::msg::LaserScan& message, const Pose2& robot_from_laser) {
  Scan scan;
  scan.stamp = from_message(message.header().stamp());
  scan.angle_min_rad = message.angle_min();
  scan.angle_increment_rad = message.angle_increment();
  scan.time_increment_s = message.time_increment();
  scan.scan_time_s = message.scan_time();
  scan.range_min_m = message.range_min();
  scan.range_max_m = message.range_max();
  scan.ranges_m = message.ranges();
  scan.robot_from_laser = robot_from_laser;
  return scan;
}

strata_msgs::msg::LabeledScan to_message(const PosedScan& scan, const std::string& frame,
                                         const std::string& laser_frame) {
  strata_msgs::msg::LabeledScan message;
  message.pose().header(make_header(scan.scan.stamp, frame));
  message.pose().run(scan.run);
  message.pose().map_from_robot().mean(to_message(scan.map_from_robot));
  message.pose().map_from_robot().covariance().fill(0.0);
  message.scan(to_message(scan.scan, laser_frame));
  message.robot_from_laser(to_message(scan.scan.robot_from_laser));
  message.static_probability(scan.static_probability);
  return message;
}

PosedScan from_message(const strata_msgs::msg::LabeledScan& message) {
  PosedScan value;
  value.run = message.pose().run();
  value.scan = from_message(message.scan(), from_message(message.robot_from_laser()));
  value.map_from_robot = from_message(message.pose().map_from_robot().mean());
  value.static_probability = message.static_probability();
  return value;
}

}  // namespace strata::convert
