// SPDX-License-Identifier: Apache-2.0
#include "components/convert/scan_messages.hpp"

#include <algorithm>
#include <cmath>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

/// No scanner has as many; what follows a scan takes time by the beam.
constexpr std::size_t kMaxBeams = 100'000;
/// A map that held what lies further away would take all memory.
constexpr double kFarthest_m = 1e5;
/// No robot is larger. A map grows at once by as much as the scanner lies off its robot.
constexpr double kFarthestMounting_m = 100.0;

bool is_within(double distance_m, const Pose2& pose) {
  return std::abs(pose.x) <= distance_m && std::abs(pose.y) <= distance_m &&
         std::isfinite(pose.theta);  // nor NaN
}

/// Whether each is a probability, or NaN where it was not estimated.
bool are_probabilities(const std::vector<float>& values) {
  return std::none_of(values.begin(), values.end(),
                      [](float value) { return value < -1e-5F || value > 1.0F + 1e-5F; });
}

void require(bool is_sound, const char* problem) {
  if (!is_sound) throw InputError("LabeledScan", problem, "check what publishes it");
}

}  // namespace

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
  if (message.ranges().size() > kMaxBeams) {
    throw InputError("LaserScan", "has " + std::to_string(message.ranges().size()) + " beams",
                     "check what publishes it");
  }
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
  const std::vector<float>& labels = message.static_probability();
  require(labels.empty() || labels.size() == message.scan().ranges().size(),
          "its labels are not one a beam");
  require(are_probabilities(labels), "its labels are not probabilities");
  require(is_within(kFarthest_m, from_message(message.pose().map_from_robot().mean())),
          "its pose is not a number, or further away than 100 km");
  require(is_within(kFarthestMounting_m, from_message(message.robot_from_laser())),
          "its mounting is not a number, or further than 100 m from the robot");
  require(std::isfinite(message.scan().angle_min()) &&
              std::isfinite(message.scan().angle_increment()) &&
              std::isfinite(message.scan().range_min()) && !std::isnan(message.scan().range_max()),
          "its angles or limits are not numbers");
  PosedScan value;
  value.run = message.pose().run();
  value.scan = from_message(message.scan(), from_message(message.robot_from_laser()));
  value.map_from_robot = from_message(message.pose().map_from_robot().mean());
  value.static_probability = message.static_probability();
  return value;
}

std::optional<Pose2> take_given(const std::optional<strata_msgs::msg::ScanPose>& given,
                                Observation& observation) {
  if (!given || from_message(given->header().stamp()) != observation.scan.stamp) return {};
  observation.run = given->run();
  const Pose2 map_from_robot = from_message(given->map_from_robot().mean());
  if (!is_finite(map_from_robot)) return {};
  return map_from_robot;
}

}  // namespace strata::convert
