// SPDX-License-Identifier: Apache-2.0
/// The beams of a scan that a sensor model looks at.
#pragma once

#include <cstddef>
#include <vector>

#include "core/scan/scan.hpp"

namespace strata::rays {

/// Which beams a beam model uses: one every 5 degrees, since neighbouring beams are not independent
/// (docs/theory/patch_localization.md, "Beam model").
struct BeamSelectionConfig {
  double min_angle_rad = 0.0873;
  double max_range_m = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.renamed("least_angle_rad", "min_angle_rad");
    v.field("min_angle_rad", c.min_angle_rad,
            {.doc = "least angle between two beams in use", .unit = "rad", .min = 0.0});
    v.field("max_range_m", c.max_range_m,
            {.doc = "readings from here on count as no return; 0: the scan's own limit",
             .unit = "m",
             .min = 0.0,
             .when = "far readings of your scanner are not to be trusted"});
  }
};

/// The beams in use, structure of arrays of equal length. Beams that are invalid or too close are
/// left out: they say nothing.
struct ScanBeams {
  Pose2 robot_from_laser;
  double r_max_m = 0.0;  ///< beyond: nothing returned
  std::vector<double> bearing_rad;
  std::vector<double> cosine;  ///< of the bearing
  std::vector<double> sine;
  std::vector<double> range_m;        ///< r_max_m where nothing returned
  std::vector<unsigned char> is_hit;  ///< 1: range_m was measured

  [[nodiscard]] std::size_t size() const { return range_m.size(); }
  /// Where a beam ends, for a laser at that pose.
  [[nodiscard]] Eigen::Vector2d end_m(const Pose2& map_from_laser, std::size_t beam) const {
    return map_from_laser * (range_m[beam] * Eigen::Vector2d(cosine[beam], sine[beam]));
  }
};

/// Every n-th beam, n the least that keeps min_angle_rad. A scan without a usable limit
/// (range_max not finite or not positive, and none configured) takes 1 m more than its longest
/// reading. O(beams).
[[nodiscard]] ScanBeams select_beams(const Scan& scan, const BeamSelectionConfig& config);

/// The same into `beams`, whose memory is kept.
void select_beams(const Scan& scan, const BeamSelectionConfig& config, ScanBeams& beams);

/// Whether any beam says something: a hit or no return.
[[nodiscard]] bool says_something(const Scan& scan);

}  // namespace strata::rays
