// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sensor_input.hpp"

#include <algorithm>
#include <cmath>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "core/geometry/pose3.hpp"
#include "core/scan/undistort.hpp"

namespace strata::runtime {
namespace {

constexpr Duration kOdometryKept{30'000'000'000};
constexpr int kDeepestFrame = 16;  // a loop in the frames must not hang us
constexpr double kLongestSweep_s = 2.0;

std::string without_slash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

Duration sweep_of(const Scan& scan) {
  const double beams = scan.size() > 0 ? static_cast<double>(scan.size() - 1) : 0.0;
  const double sweep_s = static_cast<double>(scan.time_increment_s) * beams;
  return std::abs(sweep_s) < kLongestSweep_s ? Duration::from_seconds(sweep_s) : Duration{};
}

}  // namespace

void SensorInput::add(const tf2_msgs::msg::TFMessage& transforms) {
  for (const auto& transform : transforms.transforms()) {
    parent_from_[without_slash(transform.child_frame_id())] = {
        without_slash(transform.header().frame_id()),
        planar(convert::from_message(transform.transform()))};
  }
}

void SensorInput::add(const nav_msgs::msg::Odometry& odometry) {
  const Stamp stamp = convert::from_message(odometry.header().stamp());
  if (!odometry_.empty() && stamp < odometry_.back().stamp) odometry_.clear();  // a new run
  odometry_.push_back({stamp, planar(convert::from_message(odometry.pose().pose()))});
  while (odometry_.front().stamp < stamp - kOdometryKept) odometry_.pop_front();
}

void SensorInput::add(const sensor_msgs::msg::LaserScan& scan) { scans_.push_back(scan); }

std::vector<Observation> SensorInput::take() {
  std::vector<Observation> result;
  while (!scans_.empty()) {
    const bool crowded = scans_.size() > static_cast<std::size_t>(config_.most_waiting_scans);
    if (waits_ && !crowded && !is_complete(scans_.front())) break;
    result.push_back(make(scans_.front()));
    scans_.pop_front();
  }
  return result;
}

bool SensorInput::find_mounting(const std::string& frame, Pose2& robot_from_laser) const {
  robot_from_laser = Pose2();
  std::string current = without_slash(frame);
  for (int depth = 0; depth < kDeepestFrame; ++depth) {
    if (current == config_.robot_frame) return true;
    const auto found = parent_from_.find(current);
    if (found == parent_from_.end()) return false;
    // The first step as it is: composing with the identity may change its last bits.
    robot_from_laser = depth == 0 ? found->second.second : found->second.second * robot_from_laser;
    current = found->second.first;
  }
  return false;
}

bool SensorInput::find_odometry(Stamp stamp, Pose2& pose) const {
  const auto after = std::lower_bound(odometry_.begin(), odometry_.end(), stamp,
                                      [](const TimedPose& a, Stamp b) { return a.stamp < b; });
  if (after == odometry_.end()) return false;
  if (after->stamp == stamp) {
    pose = after->pose;
    return true;
  }
  if (after == odometry_.begin()) return false;
  const TimedPose& before = *(after - 1);
  pose = interpolate(before.pose, after->pose,
                     (stamp - before.stamp).seconds() / (after->stamp - before.stamp).seconds());
  return true;
}

bool SensorInput::is_complete(const sensor_msgs::msg::LaserScan& message) const {
  Pose2 unused;
  if (!find_mounting(message.header().frame_id(), unused)) return false;
  if (!config_.use_odometry) return true;
  const Scan scan = convert::from_message(message, unused);
  return !odometry_.empty() && odometry_.back().stamp >= scan.stamp + sweep_of(scan);
}

Observation SensorInput::make(const sensor_msgs::msg::LaserScan& message) const {
  Pose2 robot_from_laser;
  if (!find_mounting(message.header().frame_id(), robot_from_laser)) robot_from_laser = Pose2();
  Observation observation;
  observation.scan = convert::from_message(message, robot_from_laser);
  Scan& scan = observation.scan;
  observation.has_odometry =
      config_.use_odometry && find_odometry(scan.stamp, observation.odom_from_robot);
  if (scan.time_increment_s != 0.0F) {
    Pose2 end;
    if (observation.has_odometry && find_odometry(scan.stamp + sweep_of(scan), end)) {
      scan = undistort(scan, between(observation.odom_from_robot, end));
    }
    scan.time_increment_s = 0.0F;
  }
  return observation;
}

}  // namespace strata::runtime
