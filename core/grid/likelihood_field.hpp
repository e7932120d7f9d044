// SPDX-License-Identifier: Apache-2.0
/// Log-likelihood of a beam's end point from its distance to the nearest occupied cell
/// [thrun2005probabilistic, table 6.3], tabulated per cell.
#pragma once

#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata {

struct LikelihoodFieldConfig {
  double hit_weight = 0.95;
  double hit_stddev_m = 0.10;
  /// Beyond this distance the likelihood stays as it is there.
  double max_distance_m = 2.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("hit_weight", c.hit_weight,
            {.doc = "share of beams that are inliers of the map; the rest is uniform",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("hit_stddev_m", c.hit_stddev_m,
            {.doc = "spread of end points about obstacles", .unit = "m", .min = 1e-3});
    v.field("max_distance_m", c.max_distance_m,
            {.doc = "distances are cut here", .unit = "m", .min = 0.05});
  }
};

/// ln[ w_h exp(-D^2 / 2 sigma^2) + (1 - w_h) ] per cell [nats], not normalized over ranges; outside
/// the grid as at max_distance_m (docs/theory/patch_localization.md, "Likelihood field"). O(cells).
class LikelihoodField {
 public:
  LikelihoodField() = default;
  LikelihoodField(const ReflectionGrid& map, const LikelihoodFieldConfig& config);

  [[nodiscard]] const Grid<float>& log_likelihood() const { return table_; }
  [[nodiscard]] double at(const Eigen::Vector2d& point_m) const {
    return static_cast<double>(table_.get(table_.cell_at(point_m)));
  }

 private:
  Grid<float> table_;
};

}  // namespace strata
