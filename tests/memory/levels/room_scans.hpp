// SPDX-License-Identifier: Apache-2.0
/// Scans of a room, and what a node in it would have seen.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "memory/levels/virtual_scan.hpp"

namespace strata::memory::room_scans {

inline constexpr double kPi = std::numbers::pi;

/// A scan of a world given as "range from this point in this direction".
using World = std::function<double(const Eigen::Vector2d&, double)>;

/// A room with walls at x = -3, 5 and y = -2, 4.
inline double room(const Eigen::Vector2d& from, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double tx = c > 0.0 ? (5.0 - from.x()) / c : (-3.0 - from.x()) / c;
  const double ty = s > 0.0 ? (4.0 - from.y()) / s : (-2.0 - from.y()) / s;
  return std::min(std::abs(tx), std::abs(ty));
}

inline PosedScan observe(const World& world, const Pose2& map_from_robot, int beams, double fov_rad,
                         const Pose2& robot_from_laser = {}) {
  PosedScan posed;
  posed.map_from_robot = map_from_robot;
  Scan& scan = posed.scan;
  scan.robot_from_laser = robot_from_laser;
  const double increment = fov_rad / beams;
  scan.angle_min_rad = static_cast<float>(-0.5 * fov_rad + 0.5 * increment);
  scan.angle_increment_rad = static_cast<float>(increment);
  scan.range_max_m = 20.0F;
  const Pose2 map_from_laser = posed.map_from_laser();
  for (int i = 0; i < beams; ++i) {
    const double angle = map_from_laser.theta + scan.bearing_rad(static_cast<std::size_t>(i));
    scan.ranges_m.push_back(static_cast<float>(world(map_from_laser.translation(), angle)));
  }
  return posed;
}

inline const PolarBins kBins{360, 50, 8.0};

inline VirtualScan transform(const PosedScan& scan, const Eigen::Vector2d& node,
                             const VisibilityConfig& config = {}) {
  VirtualScan result;
  VirtualScanner(kBins, config).transform(scan, node, result);
  return result;
}

}  // namespace strata::memory::room_scans
