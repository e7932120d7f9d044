// SPDX-License-Identifier: Apache-2.0
#include "core/rays/scan_beams.hpp"

#include <algorithm>
#include <cmath>

#include "core/scan/range_limit.hpp"

namespace strata::rays {
namespace {

double limit_of(const Scan& scan, const BeamSelectionConfig& config) {
  const float own = scan.range_max_m;
  const bool has_own = tells_reach(own);
  if (config.max_range_m > 0.0) {
    return has_own ? std::min(static_cast<double>(own), config.max_range_m) : config.max_range_m;
  }
  if (has_own) return static_cast<double>(own);
  double longest = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.kind(i) == BeamKind::kHit) {
      longest = std::max(longest, static_cast<double>(scan.ranges_m[i]));
    }
  }
  return longest + 1.0;
}

}  // namespace

ScanBeams select_beams(const Scan& scan, const BeamSelectionConfig& config) {
  ScanBeams beams;
  select_beams(scan, config, beams);
  return beams;
}

void select_beams(const Scan& scan, const BeamSelectionConfig& config, ScanBeams& beams) {
  beams.bearing_rad.clear();
  beams.cosine.clear();
  beams.sine.clear();
  beams.range_m.clear();
  beams.is_hit.clear();
  beams.robot_from_laser = scan.robot_from_laser;
  beams.r_max_m = limit_of(scan, config);
  const double increment = std::abs(static_cast<double>(scan.angle_increment_rad));
  // A hair less than the angle, so that 5 degrees of 1 degree beams are every fifth.
  const double every = increment > 0.0 ? std::ceil(config.min_angle_rad / increment - 0.01) : 1.0;
  // No more than there are: what does not fit into an integer would be a stride of 0.
  const auto stride = static_cast<std::size_t>(
      std::clamp(every, 1.0, std::max(1.0, static_cast<double>(scan.size()))));
  for (std::size_t i = 0; i < scan.size(); i += stride) {
    const BeamKind kind = scan.kind(i);
    if (kind == BeamKind::kInvalid || kind == BeamKind::kTooClose) continue;
    const auto range = static_cast<double>(scan.ranges_m[i]);
    const bool is_hit = kind == BeamKind::kHit && range < beams.r_max_m;
    const double bearing = scan.bearing_rad(i);
    beams.bearing_rad.push_back(bearing);
    beams.cosine.push_back(std::cos(bearing));
    beams.sine.push_back(std::sin(bearing));
    beams.range_m.push_back(is_hit ? range : beams.r_max_m);
    beams.is_hit.push_back(is_hit ? 1 : 0);
  }
}

bool says_something(const Scan& scan) {
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const BeamKind kind = scan.kind(i);
    if (kind == BeamKind::kHit || kind == BeamKind::kNoReturn) return true;
  }
  return false;
}

}  // namespace strata::rays
