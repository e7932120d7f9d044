// SPDX-License-Identifier: Apache-2.0
#include "core/scan/seen_surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace strata {
namespace {

/// Neighbouring beams so far apart did not meet one surface; nor is it the same one.
constexpr double kGap_m = 0.3;
/// Nor did those with more beams between them that hit nothing.
constexpr std::size_t kMaxBetween = 2;

}  // namespace

void SeenSurfaces::lay(const Scan& scan, const Pose2& laser_from_other_laser, const Scan& other) {
  ranges_m_.assign(scan.size(), kNone);
  std::size_t since = kMaxBetween + 1;  // beams without hit
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < other.size(); ++i) {
    if (other.kind(i) != BeamKind::kHit) {
      ++since;
      continue;
    }
    const auto range = static_cast<double>(other.ranges_m[i]);
    const double bearing = other.bearing_rad(i);
    const Eigen::Vector2d end = laser_from_other_laser * Eigen::Vector2d(range * std::cos(bearing),
                                                                         range * std::sin(bearing));
    if (since <= kMaxBetween && (end - last).norm() <= kGap_m) lay_piece(scan, last, end);
    last = end;
    since = 0;
  }
}

float SeenSurfaces::range_m(std::size_t beam) const {
  if (beam == 0 || beam + 1 >= ranges_m_.size()) return kNone;
  const float here = ranges_m_[beam];
  const auto gap = static_cast<float>(kGap_m);
  const bool is_met = here < kNone && std::abs(ranges_m_[beam - 1] - here) <= gap &&
                      std::abs(ranges_m_[beam + 1] - here) <= gap;
  return is_met ? here : kNone;
}

/// The beams between two ends of one surface.
void SeenSurfaces::lay_piece(const Scan& scan, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const auto beam_of = [&](const Eigen::Vector2d& p) {
    return (std::atan2(p.y(), p.x()) - static_cast<double>(scan.angle_min_rad)) /
           static_cast<double>(scan.angle_increment_rad);
  };
  const double from = beam_of(a);
  const double to = beam_of(b);
  const auto beams = static_cast<double>(scan.size());
  if (!(std::abs(from - to) < 0.25 * beams)) return;  // across the seam of the angles
  const double first = std::max(0.0, std::ceil(std::min(from, to)));
  const double end = std::min(beams, std::floor(std::max(from, to)) + 1.0);
  const Eigen::Vector2d along = b - a;
  for (double at = first; at < end; at += 1.0) {
    const auto beam = static_cast<std::size_t>(at);
    const double bearing = scan.bearing_rad(beam);
    const double across = std::cos(bearing) * along.y() - std::sin(bearing) * along.x();
    if (across == 0.0) continue;
    const auto range = static_cast<float>((a.x() * along.y() - a.y() * along.x()) / across);
    if (range > 0.0F) ranges_m_[beam] = std::min(ranges_m_[beam], range);
  }
}

float surface_that_stays_m(std::size_t beam, std::span<const SeenSurfaces> before,
                           std::span<const SeenSurfaces> after) {
  float nearest = SeenSurfaces::kNone;
  for (const SeenSurfaces& past : before) {
    const float was = past.range_m(beam);
    if (was == SeenSurfaces::kNone) continue;
    for (const SeenSurfaces& future : after) {
      const float will_be = future.range_m(beam);
      if (std::abs(was - will_be) <= static_cast<float>(kGap_m)) {
        nearest = std::min(nearest, std::max(was, will_be));
      }
    }
  }
  return nearest;
}

}  // namespace strata
