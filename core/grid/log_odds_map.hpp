// SPDX-License-Identifier: Apache-2.0
/// Occupancy by log-odds [moravec1985high, thrun2005probabilistic table 9.1], the map most robots
/// use today; here as the baseline and for online maps that must follow change.
#pragma once

#include "core/grid/counting_map.hpp"
#include "core/grid/grid.hpp"
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
  explicit LogOddsMap(double resolution_m = 0.05, LogOddsConfig config = {});

  /// Adds a scan; the static probability of a beam scales its hit. O(beams x cells a beam crosses).
  void add(const PosedScan& scan, const CountingOptions& options = {});
  [[nodiscard]] const Grid<float>& log_odds() const { return cells_; }
  /// P(occupied); unknown where the log-odds are exactly 0.
  [[nodiscard]] ReflectionGrid probability() const;

 private:
  void change(const Cell& cell, double by);
  LogOddsConfig config_;
  double hit_log_odds_;
  double miss_log_odds_;
  Grid<float> cells_;
};

}  // namespace strata
