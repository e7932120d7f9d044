// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sensor_input.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "core/base/error.hpp"
#include "core/geometry/pose3.hpp"
#include "core/scan/undistort.hpp"

namespace strata::runtime {
namespace {

constexpr Duration kOdometryKept{30'000'000'000};
constexpr double kLongestSweep_s = 2.0;

Duration sweep_of(const Scan& scan) {
  const double beams = scan.size() > 0 ? static_cast<double>(scan.size() - 1) : 0.0;
  const double sweep_s = static_cast<double>(scan.time_increment_s) * beams;
  return std::abs(sweep_s) < kLongestSweep_s ? Duration::from_seconds(sweep_s) : Duration{};
}

}  // namespace

void SensorInput::add(const tf2_msgs::msg::TFMessage& transforms) {
  for (const auto& transform : transforms.transforms()) {
    const Pose3 parent_from_child = convert::from_message(transform.transform());
    for (log::TransformTree* tree : {&fixed_, &moving_}) {
      tree->add(transform.header().frame_id(), transform.child_frame_id(), parent_from_child);
    }
  }
}

void SensorInput::add_moving(const tf2_msgs::msg::TFMessage& transforms) {
  if (has_odometry_topic_ || config_.tf_odometry_frame.empty()) return;
  const std::string frame = log::frame_name(config_.tf_odometry_frame);
  for (const auto& transform : transforms.transforms()) {
    moving_.add(transform.header().frame_id(), transform.child_frame_id(),
                convert::from_message(transform.transform()));
    // What moves is the child of odom; what hangs on it is fixed.
    if (log::frame_name(transform.header().frame_id()) != frame) continue;
    const auto odom_from_robot = moving_.find(frame, config_.robot_frame);
    if (!odom_from_robot) continue;
    add_odometry(convert::from_message(transform.header().stamp()), planar(*odom_from_robot));
  }
}

void SensorInput::add(const nav_msgs::msg::Odometry& odometry) {
  if (!has_odometry_topic_) odometry_.clear();  // what tf said
  has_odometry_topic_ = true;
  add_odometry(convert::from_message(odometry.header().stamp()),
               planar(convert::from_message(odometry.pose().pose())));
}

void SensorInput::add_odometry(Stamp stamp, const Pose2& odom_from_robot) {
  if (!is_finite(odom_from_robot)) return;  // the scans about it find their neighbours
  if (!odometry_.empty() && stamp < odometry_.back().stamp) odometry_.clear();  // a new run
  odometry_.push_back({stamp, odom_from_robot});
  while (odometry_.front().stamp < stamp - kOdometryKept) odometry_.pop_front();
}

void SensorInput::add(const sensor_msgs::msg::LaserScan& scan) {
  if (!std::isfinite(scan.angle_min()) || !std::isfinite(scan.angle_increment()) ||
      !std::isfinite(scan.range_min()) || !std::isfinite(scan.time_increment()) ||
      std::isnan(scan.range_max())) {
    throw InputError(config_.scan_topic, "a scan's angles or limits are not numbers",
                     "see what publishes it");
  }
  scans_.push_back(scan);
}

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

std::optional<Pose2> SensorInput::find_mounting(const std::string& frame) const {
  const auto robot_from_laser = fixed_.find(config_.robot_frame, frame);
  return robot_from_laser ? std::optional(planar(*robot_from_laser)) : std::nullopt;
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
  if (!find_mounting(message.header().frame_id())) return false;
  if (!config_.use_odometry) return true;
  const Scan scan = convert::from_message(message, Pose2());
  return !odometry_.empty() && odometry_.back().stamp >= scan.stamp + sweep_of(scan);
}

Observation SensorInput::make(const sensor_msgs::msg::LaserScan& message) const {
  const Pose2 robot_from_laser = find_mounting(message.header().frame_id()).value_or(Pose2());
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
