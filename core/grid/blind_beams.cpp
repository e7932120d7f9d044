// SPDX-License-Identifier: Apache-2.0
#include "core/grid/blind_beams.hpp"

#include <cmath>
#include <limits>

#include "core/grid/ray_traversal.hpp"
#include "core/scan/range_limit.hpp"

namespace strata {
namespace {

/// How far the beam says something; 0: it says nothing.
double reach_m(const Scan& scan, std::size_t beam) {
  switch (scan.kind(beam)) {
    case BeamKind::kHit:
      return static_cast<double>(scan.ranges_m[beam]);
    case BeamKind::kNoReturn:
      return static_cast<double>(scan.range_max_m);
    case BeamKind::kTooClose:
    case BeamKind::kInvalid:
      break;
  }
  return 0.0;
}

}  // namespace

std::size_t blind_beams(PosedScan& scan, const Grid<std::uint8_t>& cells) {
  if (!is_finite(scan.map_from_robot) || cells.rect().empty()) return 0;
  const Pose2 map_from_laser = scan.map_from_laser();
  const Eigen::Vector2d from_m(map_from_laser.x, map_from_laser.y);
  std::size_t blinded = 0;
  for (std::size_t i = 0; i < scan.scan.size(); ++i) {
    const double range_m = reach_m(scan.scan, i);
    if (!(range_m > 0.0) || !std::isfinite(range_m)) continue;
    const double bearing_rad = map_from_laser.theta + scan.scan.bearing_rad(i);
    const Eigen::Vector2d to_m =
        from_m + range_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    bool touches = false;
    traverse_ray(from_m, to_m, cells.resolution_m(), [&](const Cell& cell, double) {
      touches = cells.get(cell) != 0;
      return !touches;
    });
    if (!touches) continue;
    scan.scan.ranges_m[i] = std::numeric_limits<float>::quiet_NaN();
    ++blinded;
  }
  return blinded;
}

}  // namespace strata
