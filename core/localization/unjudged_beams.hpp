// SPDX-License-Identifier: Apache-2.0
/// Which beams of a scan a map says nothing of, since nobody has been where they go
/// (docs/theory/patch_localization.md, "Where the map ends").
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "core/localization/inlier_shares.hpp"
#include "core/scan/scan.hpp"

namespace strata::localization {

/// A beam may go so far through unknown cells: walls have some between their sides, and so has
/// every floor between the beams of the scans that mapped it.
inline constexpr double kMaxUnknownWay_m = 0.3;
/// Beams closer together than this are judged by one of them.
inline constexpr double kJudgedTogether_rad = 0.03;

/// How far a way leads through unknown cells, looked at every step_m, until that is more than
/// enough_m. Points in the map frame [m]. O((map's extent along it + enough_m) / step_m).
template <LimitedMap Map>
[[nodiscard]] double unknown_way_m(const Map& map, const Eigen::Vector2d& from_m,
                                   const Eigen::Vector2d& direction, double range_m,
                                   double enough_m = std::numeric_limits<double>::infinity(),
                                   double step_m = 0.05) {
  const double steps = std::floor(std::max(0.0, range_m / step_m));
  double unknown = 0.0;
  for (double n = 0.0; n < steps && unknown * step_m <= enough_m; n += 1.0) {
    const double at_m = (n + 0.5) * step_m;
    unknown += map.knows(from_m + at_m * direction) ? 0.0 : 1.0;
  }
  return unknown * step_m;
}

/// So many beams lie within that angle: at least 1, at most all. Of increments that are none 1.
[[nodiscard]] inline std::size_t beams_within(const Scan& scan, double angle_rad) {
  const double step_rad = std::abs(static_cast<double>(scan.angle_increment_rad));
  const double beams = angle_rad / step_rad;
  if (!(step_rad > 0.0 && beams > 1.0)) return 1;
  const auto all = static_cast<double>(scan.size());
  return static_cast<std::size_t>(std::max(1.0, std::min(beams, all)));
}

/// Marks (1) the beams that the map does not judge from this pose: those that end where it knows
/// nothing, and those whose way up to the first obstacle leads through such places, where another
/// one may stand. A wall that was mapped from its other side only is seen through such a place,
/// and lies a wall's thickness further away than it seems. A beam that goes through an obstacle of
/// the map is judged: the pose, or the map, is wrong. expected_m(beam, direction, limit_m): metres
/// to the first obstacle of the map from the laser, anything above limit_m when there is none
/// before; direction in the map frame. tolerance_m: within it a beam ends at what it was expected
/// to end at. O(beams x cells on their way).
template <LimitedMap Map, typename Expected>
void mark_unjudged(const Map& map, const Scan& scan, const Pose2& map_from_laser,
                   double tolerance_m, Expected&& expected_m,
                   std::vector<std::uint8_t>& is_unjudged) {
  constexpr double kFar_m = 100.0;
  is_unjudged.assign(scan.size(), 0);
  const Eigen::Vector2d laser_m = map_from_laser.translation();
  const bool is_known_here = map.knows(laser_m);
  const auto judge = [&](std::size_t beam) {
    const BeamKind kind = scan.kind(beam);
    if (kind != BeamKind::kHit && kind != BeamKind::kNoReturn) return false;
    const double heading = map_from_laser.theta + scan.bearing_rad(beam);
    const Eigen::Vector2d direction(std::cos(heading), std::sin(heading));
    if (kind == BeamKind::kNoReturn) {
      return !is_known_here && !(expected_m(beam, direction, kFar_m) <= kFar_m);
    }
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    const double obstacle_m = expected_m(beam, direction, range_m + tolerance_m);
    if (obstacle_m + tolerance_m < range_m) return false;
    const double way_m = std::min(obstacle_m, range_m);
    if (unknown_way_m(map, laser_m, direction, way_m, kMaxUnknownWay_m) > kMaxUnknownWay_m) {
      return true;
    }
    return obstacle_m > range_m + tolerance_m &&
           !knows_end(map, laser_m, laser_m + range_m * direction, tolerance_m);
  };
  const std::size_t together = beams_within(scan, kJudgedTogether_rad);
  for (std::size_t begin = 0; begin < scan.size(); begin += together) {
    const std::size_t end = std::min(begin + together, scan.size());
    if (!judge(begin + (end - begin) / 2)) continue;
    std::fill(is_unjudged.begin() + static_cast<std::ptrdiff_t>(begin),
              is_unjudged.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{1});
  }
}

}  // namespace strata::localization
