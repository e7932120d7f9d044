// SPDX-License-Identifier: Apache-2.0
/// A room that tells its places apart, a drive through it and the scans of that.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"

namespace strata::test {

inline constexpr double kStepM = 0.2;
inline constexpr double kStepS = 0.25;

/// How far it is to the walls of a room of 14 m by 4 m with a pillar's niche at one end.
inline double range_in_room(double x, double y, double angle) {
  double range_m = 0.0;
  const auto is_open = [](double px, double py) {
    const bool room = px > 0.0 && px < 14.0 && py > 0.0 && py < 4.0;
    const bool niche = px > 5.0 && px < 6.0 && py >= 4.0 && py < 5.0;
    return room || niche;
  };
  while (range_m < 20.0 && is_open(x + range_m * std::cos(angle), y + range_m * std::sin(angle))) {
    range_m += 0.01;
  }
  return range_m;
}

/// The robot goes from x = 2 m to x = 12 m and back, looking ahead and aside.
struct Moment {
  double time_s = 0.0;
  Pose2 pose;
};
inline std::vector<Moment> there_and_back() {
  std::vector<Moment> drive;
  for (int i = 0; i <= 50; ++i) drive.push_back({1.0 + kStepS * i, {2.0 + kStepM * i, 2.0, 0.0}});
  for (int i = 1; i <= 8; ++i) {
    drive.push_back({drive.back().time_s + kStepS, {12.0, 2.0, std::numbers::pi * i / 8.0}});
  }
  for (int i = 1; i <= 50; ++i) {
    drive.push_back({drive.back().time_s + kStepS, {12.0 - kStepM * i, 2.0, std::numbers::pi}});
  }
  return drive;
}

inline Scan scan_at(const Moment& moment) {
  Scan scan;
  scan.stamp = Stamp::from_seconds(moment.time_s);
  scan.angle_min_rad = static_cast<float>(-std::numbers::pi);
  scan.angle_increment_rad = static_cast<float>(std::numbers::pi / 90.0);
  scan.range_max_m = 20.0F;
  for (std::size_t i = 0; i < 180; ++i) {
    scan.ranges_m.push_back(static_cast<float>(
        range_in_room(moment.pose.x, moment.pose.y, moment.pose.theta + scan.bearing_rad(i))));
  }
  return scan;
}

}  // namespace strata::test
