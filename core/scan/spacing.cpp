// SPDX-License-Identifier: Apache-2.0
#include "core/scan/spacing.hpp"

#include <cmath>
#include <cstddef>

#include "core/geometry/angle.hpp"

namespace strata {

std::vector<PosedScan> spaced(std::span<const PosedScan> scans, const SpacingConfig& config) {
  if (config.spacing_m <= 0.0) return {scans.begin(), scans.end()};
  std::vector<PosedScan> kept;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (!kept.empty() && i + 1 < scans.size()) {
      const Pose2& before = kept.back().map_from_robot;
      const Pose2& now = scans[i].map_from_robot;
      const bool is_near = translation_distance(before, now) < config.spacing_m &&
                           std::abs(angle_difference(now.theta, before.theta)) < config.spacing_rad;
      const double since_s = (scans[i].scan.stamp - kept.back().scan.stamp).seconds();
      if (is_near && since_s < config.spacing_s) continue;
    }
    kept.push_back(scans[i]);
  }
  return kept;
}

}  // namespace strata
