// SPDX-License-Identifier: Apache-2.0
/// What a 2-D scanner saw move, as boxes that 3-D points are judged by
/// [stachniss2003chapter, section 1.5.1] (docs/theory/static_3d.md, "Boxes of moving things").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/base/time.hpp"
#include "core/scan/scan.hpp"
#include "core/volume/cloud.hpp"

namespace strata::volume {

struct DynamicBoxConfig {
  double window_s = 0.25;
  double link_m = 0.3;
  int min_points = 3;
  double margin_m = 0.25;
  double lowest_m = 0.05;
  double highest_m = 2.2;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("window_s", c.window_s,
            {.doc = "2-D beams this much before or after a point was measured speak for it; half "
                    "the sweep goes on top where a cloud does not say when each was",
             .unit = "s",
             .min = 0.0});
    v.field("link_m", c.link_m,
            {.doc = "points nearer than this belong together", .unit = "m", .min = 0.01});
    v.renamed("least_points", "min_points");
    v.field("min_points", c.min_points, {.doc = "fewer make no box", .unit = "1", .min = 1.0});
    v.field("margin_m", c.margin_m,
            {.doc = "a box reaches this much beyond its points", .unit = "m", .min = 0.0});
    v.field("lowest_m", c.lowest_m,
            {.doc = "lower end of a box in the map frame: above the floor, which is no part of "
                    "whoever stands on it",
             .unit = "m"});
    v.field("highest_m", c.highest_m, {.doc = "upper end", .unit = "m"});
    v.require(c.lowest_m < c.highest_m, "highest_m", "is not above lowest_m", "raise it");
  }
};

/// The end of a beam that hit something moving, in the map frame.
struct DynamicPoint {
  Stamp stamp;
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
};

/// The ends of hits whose static probability is below one half, by stamp. O(beams log beams).
[[nodiscard]] std::vector<DynamicPoint> dynamic_points(std::span<const PosedScan> scans);

/// An upright box [m], in the plane.
struct DynamicBox {
  Eigen::Vector2d low_m;
  Eigen::Vector2d high_m;
};

/// Finds the boxes of a moment and the 3-D points in them.
class DynamicBoxes {
 public:
  /// points: by stamp. Throws ConfigError.
  DynamicBoxes(const DynamicBoxConfig& config, std::vector<DynamicPoint> points);

  /// The boxes about the points of [stamp - window, stamp + window], the window widened by
  /// longer_s: single-linkage clusters. O(n^2) of the points in the window.
  [[nodiscard]] std::vector<DynamicBox> at(Stamp stamp, double longer_s = 0.0) const;
  /// A flag a point: 1 inside a box of its part's moment; in a cloud without parts, of the cloud's,
  /// the window widened by half its sweep. O(points x boxes).
  [[nodiscard]] std::vector<std::uint8_t> label(const Cloud& cloud) const;

 private:
  DynamicBoxConfig config_;
  std::vector<DynamicPoint> points_;
};

}  // namespace strata::volume
