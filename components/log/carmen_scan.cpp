// SPDX-License-Identifier: Apache-2.0
#include "components/log/carmen_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/log/text.hpp"
#include "core/geometry/angle.hpp"

namespace strata::log {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

void mark_no_returns(std::vector<CarmenScan>& scans, ReadReport& report) {
  float code = kSickMaximum;
  std::vector<float> readings;
  for (const CarmenScan& raw : scans) {
    for (const float range : raw.observation.scan.ranges_m) {
      if (!raw.states_maximum && range < kSickMaximum && range > 1.0F) readings.push_back(range);
    }
  }
  const bool has_sick_code = std::any_of(scans.begin(), scans.end(), [](const CarmenScan& raw) {
    return !raw.states_maximum &&
           std::any_of(raw.observation.scan.ranges_m.begin(), raw.observation.scan.ranges_m.end(),
                       [](float r) { return r >= kSickMaximum; });
  });
  if (!readings.empty() && !has_sick_code) {
    const float top = *std::max_element(readings.begin(), readings.end());
    const auto within = [&](float from, float to) {
      return std::count_if(readings.begin(), readings.end(),
                           [&](float r) { return r >= from && r < to; });
    };
    const auto pile = within(top - 0.1F, top + 1.0F);
    if (pile >= 20 && pile >= 10 * within(top - 1.1F, top - 0.1F)) {
      code = top + 1.0F;
      for (const float r : readings) {
        if (r >= top - 0.1F) code = std::min(code, r);
      }
      report.warnings.push_back("readings from " + format_number(code) +
                                " m on pile up and are taken for no return");
    }
  }
  for (CarmenScan& raw : scans) {
    Scan& scan = raw.observation.scan;
    if (!raw.states_maximum) scan.range_max_m = code;
    for (float& range : scan.ranges_m) {
      if (range >= scan.range_max_m) range = kInfinity;
    }
  }
}

void find_mounting(std::vector<CarmenScan>& scans, std::optional<double> front_laser_offset,
                   ReadReport& report) {
  std::vector<double> x, y, theta;
  for (const CarmenScan& raw : scans) {
    const Pose2 difference = between(raw.observation.odom_from_robot, raw.laser_pose);
    x.push_back(difference.x);
    y.push_back(difference.y);
    theta.push_back(difference.theta);
  }
  // Rounded: the poses carry few decimals, and the mounting of a robot is not known better.
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return std::round(*middle * 1e4) / 1e4 + 0.0;
  };
  Pose2 mounting{median(x), median(y), median(theta)};
  report.mounting_source = "laser - odometry";
  const auto differs = [&](const CarmenScan& raw) {
    const Pose2 seen = between(raw.observation.odom_from_robot, raw.laser_pose);
    return translation_distance(seen, mounting) > 0.02 ||
           std::abs(angle_difference(seen.theta, mounting.theta)) > 0.02;
  };
  const auto odd = static_cast<std::size_t>(std::count_if(scans.begin(), scans.end(), differs));
  if (2 * odd > scans.size()) {
    mounting = {front_laser_offset.value_or(0.0), 0.0, 0.0};
    report.mounting_source = front_laser_offset ? "PARAM robot_frontlaser_offset" : "assumed";
    report.warnings.push_back(
        "laser and odometry poses drift apart (a corrected log?); the laser is taken to be " +
        format_number(mounting.x) + " m ahead");
  }
  for (CarmenScan& raw : scans) raw.observation.scan.robot_from_laser = mounting;
}

}  // namespace strata::log
