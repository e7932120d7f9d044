// SPDX-License-Identifier: Apache-2.0
#include "components/log/joined_scan.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>
#include <utility>

#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/transform_tree.hpp"
#include "core/base/error.hpp"
#include "core/geometry/odometry_noise.hpp"

namespace strata::log {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
/// The first beams of some scanners overlap their last.
constexpr double kMostTurns = 2.0;

/// From the first beam to the last.
double field_rad(const sensor_msgs::msg::LaserScan& message) {
  const double beams = static_cast<double>(std::max<std::size_t>(message.ranges().size(), 1));
  return (beams - 1.0) * static_cast<double>(message.angle_increment());
}

/// Taken as they are they would make maps that nobody recognizes.
void require_angles(const sensor_msgs::msg::LaserScan& message, const std::string& place) {
  const std::string beams = std::to_string(message.ranges().size()) + " beams";
  if (message.ranges().size() > 1 && message.angle_increment() == 0.0F) {
    throw InputError(place, "a scan's " + beams + " have an angle_increment of 0",
                     "set it where the scan is published");
  }
  if (std::abs(field_rad(message)) <= kMostTurns * kTurn) return;
  std::ostringstream text;
  text << "a scan's " << beams << " with an angle_increment of " << message.angle_increment()
       << " rad go around " << std::round(std::abs(field_rad(message)) / kTurn) << " times";
  throw InputError(place, text.str(), "publish angles in radians");
}

/// The moment furthest from the stamp, that of one end of the sweep; 0 where no times are told.
double furthest_offset_s(const std::vector<float>& offset_s) {
  double furthest = 0.0;
  for (const float offset : offset_s) {
    const auto value = static_cast<double>(offset);
    const bool is_sound = std::abs(value) < kLongestSweepS;  // false for NaN
    if (is_sound && std::abs(value) > std::abs(furthest)) furthest = value;
  }
  return furthest;
}

Scan undistorted(const SensedScan& sensed, const OdometryAt& odometry, const Pose2& at_stamp,
                 Stamp begin, const SweepTiming& timing) {
  const Scan& scan = sensed.scan;
  const double offset_s = furthest_offset_s(sensed.offset_s);
  const Duration sweep = sensed.is_cloud ? Duration::from_seconds(offset_s) : sweep_duration(scan);
  const auto end = odometry && sweep.ns != 0 ? odometry(begin + sweep) : std::nullopt;
  if (!end) return scan;
  const Pose2 start_from_end = between(at_stamp, *end);
  // Stamps within a sweep are by one clock, so that less slack does than from scan to scan.
  constexpr OdometryLimits kWithinSweep{.slack_m = 0.2, .slack_rad = 0.3};
  if (!is_possible(start_from_end, std::abs(sweep.seconds()), kWithinSweep)) return scan;
  if (sensed.is_cloud) return undistort(scan, sensed.offset_s, start_from_end, offset_s);
  return undistort(scan, start_from_end, timing.reversed);
}

}  // namespace

SensedScan sensed(const sensor_msgs::msg::LaserScan& message, const std::string& place) {
  SensedScan result;
  result.frame = frame_name(message.header().frame_id());
  result.scan = convert::from_message(message, Pose2{});
  Scan& scan = result.scan;
  if (!std::isfinite(scan.angle_min_rad) || !std::isfinite(scan.angle_increment_rad) ||
      !std::isfinite(scan.range_min_m) || std::isnan(scan.range_max_m)) {
    throw InputError(place, "a scan's angles or limits are not numbers", "see what publishes it");
  }
  require_angles(message, place);
  if (!std::isfinite(scan.time_increment_s)) scan.time_increment_s = 0.0F;
  return result;
}

std::string doubt_angles(const sensor_msgs::msg::LaserScan& message) {
  constexpr double kUsualBeams = 2.0;
  constexpr double kUsualShare = 0.01;  // of the field
  const bool is_told = message.angle_max() != 0.0F && message.angle_max() != message.angle_min();
  if (!is_told || !std::isfinite(message.angle_max())) return "";
  const double field = field_rad(message);
  const double end = static_cast<double>(message.angle_min()) + field;
  const double apart =
      std::abs(std::remainder(end - static_cast<double>(message.angle_max()), kTurn));
  const double increment = std::abs(static_cast<double>(message.angle_increment()));
  if (apart <= kUsualBeams * increment + kUsualShare * std::abs(field)) return "";
  std::ostringstream text;
  text << std::setprecision(4) << "angle_max is " << message.angle_max() << " rad, but "
       << message.ranges().size() << " beams with an angle_increment of "
       << message.angle_increment() << " rad end at " << end
       << " rad; angle_increment is believed, see what publishes it";
  return text.str();
}

SensedScan sensed(const sensor_msgs::msg::PointCloud2& message) {
  SensedScan result;
  result.is_cloud = true;
  result.frame = frame_name(message.header().frame_id());
  result.scan.stamp = convert::from_message(message.header().stamp());
  result.points_m = convert::from_message(message);
  result.offset_s = convert::columns_of(message).offset_s;
  for (float& offset : result.offset_s) {
    if (!(std::abs(static_cast<double>(offset)) < kLongestSweepS)) offset = 0.0F;
  }
  return result;
}

bool is_blank(const Scan& scan) {
  return std::all_of(scan.ranges_m.begin(), scan.ranges_m.end(),
                     [](float range) { return std::isnan(range); });
}

void mount(SensedScan& sensed, const Pose3& robot_from_sensor, const CloudSliceConfig& slice) {
  Scan& scan = sensed.scan;
  if (sensed.is_cloud) {
    CloudSlice cut =
        slice_cloud(sensed.points_m, sensed.offset_s, scan.stamp, robot_from_sensor, slice);
    scan = std::move(cut.scan);
    sensed.offset_s = std::move(cut.offset_s);
    sensed.points_m = {};
    return;
  }
  scan.robot_from_laser = planar(robot_from_sensor);
  if (!is_upside_down(robot_from_sensor)) return;
  const double last = scan.size() == 0 ? 0.0 : scan.bearing_rad(scan.size() - 1);
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  scan.angle_min_rad = static_cast<float>(-last);
}

std::string doubt_mounting(const std::string& frame, const Pose3& robot_from_laser) {
  constexpr double kUsual_rad = 5.0 * kTurn / 360.0;
  const double up = (robot_from_laser.rotation * Eigen::Vector3d::UnitZ()).z();
  const double tilt_rad = std::acos(std::min(1.0, std::abs(up)));
  if (!(tilt_rad > kUsual_rad)) return "";
  return frame + " is tilted by " + std::to_string(std::lround(tilt_rad * 360.0 / kTurn)) +
         " degrees, as tf tells, and its beams are taken for level; mend the transform, or leave "
         "the scanner out";
}

std::optional<Observation> join(SensedScan sensed, const OdometryAt& odometry,
                                const SweepTiming& timing, bool undistort) {
  Observation observation;
  observation.has_odometry = odometry != nullptr;
  const Stamp begin = sensed.scan.stamp - Duration::from_seconds(timing.delay_s);
  if (odometry) {
    const auto pose = odometry(begin);
    if (!pose) return std::nullopt;
    observation.odom_from_robot = *pose;
  }
  if (undistort) {
    sensed.scan = undistorted(sensed, odometry, observation.odom_from_robot, begin, timing);
    sensed.scan.time_increment_s = 0.0F;
  }
  observation.scan = std::move(sensed.scan);
  return observation;
}

Stamp end_of_sweep(const SensedScan& sensed) {
  const Stamp stamp = sensed.scan.stamp;
  const Duration sweep = sensed.is_cloud
                             ? Duration::from_seconds(furthest_offset_s(sensed.offset_s))
                             : sweep_duration(sensed.scan);
  return std::max(stamp, stamp + sweep);
}

}  // namespace strata::log
