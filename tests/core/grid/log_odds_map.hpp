// SPDX-License-Identifier: Apache-2.0
/// Occupancy by log-odds [moravec1985high, thrun2005probabilistic table 9.1], which must add up to
/// what the counting map counts.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/config.hpp"
#include "core/grid/count_scans.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/ray_traversal.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata {

struct LogOddsConfig {
  double hit_probability = 0.7;
  double miss_probability = 0.4;
  double clamp_log_odds = 6.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "hit_probability", c.hit_probability,
        {.doc = "P(occupied) that one beam end alone gives", .unit = "1", .min = 0.5, .max = 1.0});
    v.field("miss_probability", c.miss_probability,
            {.doc = "P(occupied) that one crossing of a whole cell alone gives",
             .unit = "1",
             .min = 0.0,
             .max = 0.5});
    v.field(
        "clamp_log_odds", c.clamp_log_odds,
        {.doc = "bound on |log odds|; lower follows change faster", .unit = "nats", .min = 0.1});
    v.require(c.hit_probability > 0.5 && c.hit_probability < 1.0, "hit_probability",
              "lies on a border, where a hit says nothing or everything",
              "choose a value between 0.5 and 1");
    v.require(c.miss_probability < 0.5 && c.miss_probability > 0.0, "miss_probability",
              "lies on a border, where a miss says nothing or everything",
              "choose a value between 0 and 0.5");
  }
};

/// Log-odds of occupancy per cell, 0 where nothing was seen; misses weighted by length like the
/// counting map's.
class LogOddsMap {
 public:
  explicit LogOddsMap(double resolution_m = 0.05, LogOddsConfig config = {})
      : config_(config),
        hit_log_odds_(log_odds_of(config.hit_probability)),
        miss_log_odds_(log_odds_of(config.miss_probability)),
        cells_(resolution_m, CellRect{}, 0.0F) {
    require_valid(config, "log_odds_map");
  }

  /// Adds a scan; the static probability of a beam scales its hit. O(beams x cells a beam crosses).
  void add(const PosedScan& scan, const CountingOptions& options = {}) {
    const double resolution = cells_.resolution_m();
    const CellRect extent = extent_of(scan, resolution, options);
    if (extent.empty()) return;
    cells_.grow(with_room(cells_.rect(), extent));
    for_each_ray(scan.scan, scan.map_from_laser(), options, [&](std::size_t beam, const Ray& ray) {
      const Cell end = cell_at(ray.to_m, resolution);
      traverse_ray(ray.from_m, ray.to_m, resolution, [&](const Cell& cell, double length_m) {
        if (ray.is_hit && cell == end) return;
        change(cell, miss_log_odds_ * length_m / resolution);
      });
      if (!ray.is_hit) return;
      const double e = scan.static_probability.empty()
                           ? 1.0
                           : static_cast<double>(scan.static_probability[beam]);
      change(end, e * hit_log_odds_);
    });
  }
  [[nodiscard]] const Grid<float>& log_odds() const { return cells_; }
  /// P(occupied); unknown where the log-odds are exactly 0.
  [[nodiscard]] ReflectionGrid probability() const {
    ReflectionGrid result = make_reflection_grid(cells_.resolution_m(), cells_.rect());
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const double value = static_cast<double>(cells_.values()[i]);
      if (value != 0.0) result.values()[i] = static_cast<float>(1.0 / (1.0 + std::exp(-value)));
    }
    return result;
  }

 private:
  static double log_odds_of(double probability) {
    return std::log(probability / (1.0 - probability));
  }
  void change(const Cell& cell, double by) {
    float& value = cells_.at(cell);
    value = static_cast<float>(std::clamp(static_cast<double>(value) + by, -config_.clamp_log_odds,
                                          config_.clamp_log_odds));
  }
  LogOddsConfig config_;
  double hit_log_odds_;
  double miss_log_odds_;
  Grid<float> cells_;
};

}  // namespace strata
