// SPDX-License-Identifier: Apache-2.0
#include "components/log/carmen_scan.hpp"

#include <algorithm>
#include <cmath>

#include "components/log/no_return_limit.hpp"
#include "components/log/text.hpp"
#include "core/geometry/angle.hpp"
#include "core/scan/no_return.hpp"

namespace strata::log {
namespace {

/// Of FLASER or of ROBOTLASER1 lines.
void mark_no_returns_of(bool states_maximum, std::vector<CarmenScan>& scans,
                        const ReadOptions& options, ReadReport& report) {
  std::vector<RangedScan> ranged;
  for (CarmenScan& raw : scans) {
    if (raw.states_maximum != states_maximum) continue;
    ranged.push_back({&raw.observation.scan, raw.observation.odom_from_robot});
  }
  if (ranged.empty()) return;
  settle_no_returns(ranged, "",
                    states_maximum ? "the log states it"
                                   : "as a SICK has it, whose codes are 81.83 to 81.91 m; the log "
                                     "states nothing",
                    options, report);
  for (const RangedScan& scan : ranged) set_range_limit(*scan.scan, scan.scan->range_max_m);
}

}  // namespace

void mark_no_returns(std::vector<CarmenScan>& scans, const ReadOptions& options,
                     ReadReport& report) {
  for (const bool states_maximum : {false, true}) {
    mark_no_returns_of(states_maximum, scans, options, report);
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
