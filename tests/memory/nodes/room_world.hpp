// SPDX-License-Identifier: Apache-2.0
/// A room with walls at x = -4, 5 and y = -3, 3, with or without a wide box, seen by a scanner.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"

namespace strata::memory::test_world {

/// Range to the inside of an axis-parallel rectangle.
inline double inside_rectangle(const Eigen::Vector2d& from, double angle, double x0, double y0,
                               double x1, double y1) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double tx = ((c > 0.0 ? x1 : x0) - from.x()) / c;
  const double ty = ((s > 0.0 ? y1 : y0) - from.y()) / s;
  return std::min(tx > 0.0 ? tx : 1e9, ty > 0.0 ? ty : 1e9);
}

/// Range to the outside of one; 1e9 when the beam misses it.
inline double outside_rectangle(const Eigen::Vector2d& from, double angle, double x0, double y0,
                                double x1, double y1) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double enter_x = ((c > 0.0 ? x0 : x1) - from.x()) / c;
  const double leave_x = ((c > 0.0 ? x1 : x0) - from.x()) / c;
  const double enter_y = ((s > 0.0 ? y0 : y1) - from.y()) / s;
  const double leave_y = ((s > 0.0 ? y1 : y0) - from.y()) / s;
  const double enter = std::max(enter_x, enter_y);
  return enter > 0.0 && enter < std::min(leave_x, leave_y) ? enter : 1e9;
}

inline double range_m(const Eigen::Vector2d& from, double angle, bool with_box) {
  const double wall = inside_rectangle(from, angle, -4.0, -3.0, 5.0, 3.0);
  if (!with_box) return wall;
  return std::min(wall, outside_rectangle(from, angle, 2.0, -1.0, 3.0, 1.0));
}

inline PosedScan observe(const Pose2& map_from_robot, double time_s, bool with_box,
                         std::uint64_t seed = 1, double noise_m = 0.01) {
  PosedScan posed;
  posed.map_from_robot = map_from_robot;
  Scan& scan = posed.scan;
  scan.stamp = Stamp::from_seconds(time_s);
  scan.angle_min_rad = static_cast<float>(-std::numbers::pi);
  scan.angle_increment_rad = static_cast<float>(std::numbers::pi / 180.0);
  scan.range_max_m = 30.0F;
  RandomStream random(seed, StreamId::kTest, static_cast<std::uint64_t>(scan.stamp.ns));
  for (std::size_t i = 0; i < 360; ++i) {
    const double angle = map_from_robot.theta + scan.bearing_rad(i);
    const double range = range_m(map_from_robot.translation(), angle, with_box);
    scan.ranges_m.push_back(static_cast<float>(range + random.normal(0.0, noise_m)));
  }
  return posed;
}

}  // namespace strata::memory::test_world
