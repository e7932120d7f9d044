// SPDX-License-Identifier: Apache-2.0
/// A room of straight walls and exact scans of it, for tests of matching. Shares no code with the
/// library's ray casting.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"

namespace strata::test {

struct Wall {
  double x0, y0, x1, y1;
};

/// Distance along the ray to the wall, or infinity.
inline double range_to(const Wall& wall, double x, double y, double angle) {
  const double dx = std::cos(angle);
  const double dy = std::sin(angle);
  const double wx = wall.x1 - wall.x0;
  const double wy = wall.y1 - wall.y0;
  const double det = wx * dy - wy * dx;
  if (std::abs(det) < 1e-12) return std::numeric_limits<double>::infinity();
  const double rx = wall.x0 - x;
  const double ry = wall.y0 - y;
  const double t = (wx * ry - wy * rx) / det;
  const double s = (dx * ry - dy * rx) / det;
  if (t < 0.0 || s < 0.0 || s > 1.0) return std::numeric_limits<double>::infinity();
  return t;
}

/// A scan with `beams` beams over `field_of_view_rad`, noise in metres.
inline Scan scan_of(const std::vector<Wall>& walls, const Pose2& map_from_robot, double stamp_s,
                    double noise_m = 0.0, std::uint64_t seed = 1, int beams = 180,
                    double field_of_view_rad = std::numbers::pi, double range_max_m = 20.0) {
  Scan scan;
  scan.stamp = Stamp::from_seconds(stamp_s);
  scan.angle_increment_rad = static_cast<float>(field_of_view_rad / beams);
  scan.angle_min_rad =
      static_cast<float>(-0.5 * field_of_view_rad) + 0.5F * scan.angle_increment_rad;
  scan.range_min_m = 0.01F;
  scan.range_max_m = static_cast<float>(range_max_m);
  RandomStream random(seed, StreamId::kTest, static_cast<std::uint64_t>(scan.stamp.ns));
  for (int i = 0; i < beams; ++i) {
    const double angle = map_from_robot.theta + scan.bearing_rad(static_cast<std::size_t>(i));
    double range_m = std::numeric_limits<double>::infinity();
    for (const Wall& wall : walls) {
      range_m = std::min(range_m, range_to(wall, map_from_robot.x, map_from_robot.y, angle));
    }
    range_m += noise_m * random.normal();
    scan.ranges_m.push_back(range_m < range_max_m ? static_cast<float>(range_m)
                                                  : std::numeric_limits<float>::infinity());
  }
  return scan;
}

/// A closed room of 8 m x 6 m with a box and a niche, so that it looks the same from nowhere else.
inline std::vector<Wall> room() {
  return {{0.0, 0.0, 8.0, 0.0}, {8.0, 0.0, 8.0, 6.0}, {8.0, 6.0, 5.0, 6.0}, {5.0, 6.0, 5.0, 7.0},
          {5.0, 7.0, 4.0, 7.0}, {4.0, 7.0, 4.0, 6.0}, {4.0, 6.0, 0.0, 6.0}, {0.0, 6.0, 0.0, 0.0},
          {2.0, 2.0, 2.6, 2.0}, {2.6, 2.0, 2.6, 2.4}, {2.6, 2.4, 2.0, 2.4}, {2.0, 2.4, 2.0, 2.0}};
}

}  // namespace strata::test
