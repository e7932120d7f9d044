// SPDX-License-Identifier: Apache-2.0
/// What a timescale memory keeps, where, and how fast it forgets.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/base/config.hpp"
#include "memory/levels/level_config.hpp"
#include "memory/levels/polar_bins.hpp"
#include "memory/levels/virtual_scan.hpp"

namespace strata::memory {

/// The defaults suit whole buildings; `paper_timescale_config` gives the paper's experiment.
struct TimescaleConfig {
  int angle_bins = 360;
  int range_bins = 50;
  double max_range_m = 8.0;

  /// As large as the update radius: between a smaller radius and a larger spacing no node would
  /// learn (docs/theory/timescale_memory.md, "Nodes"), nor places far from every node be seen well.
  double node_spacing_m = 1.0;   ///< a scan that sees no node within this makes one
  double update_radius_m = 1.0;  ///< a scan updates the nearest node it sees, within this
  double max_position_std_m = 0.1;
  double max_heading_std_rad = 0.05;

  /// A node takes a scan at most once per period, or sooner when the robot has moved: a half-life
  /// then means the same for a scanner of 9 Hz and one of 40 Hz, and standing still teaches little.
  double period_s = 1.0;
  double travel_m = 0.2;
  double turn_rad = 0.17453292519943295;

  /// Until a node has been observed N / q times, a level takes an observation with probability
  /// N / (observations so far): the set is then an even sample of all of them, instead of empty for
  /// the first minutes. The half-life holds from there on.
  bool warm_up = true;
  bool coupled_eviction = false;
  VisibilityConfig visibility;
  /// Samples survive 3.1, 27 and 693 seconds of presence.
  std::vector<LevelConfig> levels = {{"short", 5, 3.1}, {"mid", 20, 27.0}, {"long", 50, 693.0}};

  friend bool operator==(const TimescaleConfig&, const TimescaleConfig&) = default;

  [[nodiscard]] PolarBins bins() const { return {angle_bins, range_bins, max_range_m}; }

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("angle_bins", c.angle_bins, {.doc = "angle bins a node", .min = 3, .max = 3600});
    v.field("range_bins", c.range_bins,
            {.doc = "range bins an angle bin, without the overflow bin",
             .min = 1,
             .max = 254,
             .preset = {"paper-timescale", "20"}});
    v.field("max_range_m", c.max_range_m,
            {.doc = "ranges from here on share the overflow bin",
             .unit = "m",
             .min = 0.01,
             .when = "rooms are larger than 16 m across, or only the near shall be remembered",
             .preset = {"paper-timescale", "1.5"}});
    v.field("node_spacing_m", c.node_spacing_m,
            {.doc = "a node is made where none is seen within this", .unit = "m", .min = 0.01});
    v.field(
        "update_radius_m", c.update_radius_m,
        {.doc = "a scan updates the nearest node it sees within this", .unit = "m", .min = 0.01});
    v.field("max_position_std_m", c.max_position_std_m,
            {.doc = "scans of less certain position are not remembered", .unit = "m", .min = 0.0});
    v.field("max_heading_std_rad", c.max_heading_std_rad,
            {.doc = "scans of less certain heading are not remembered", .unit = "rad", .min = 0.0});
    v.field("period_s", c.period_s,
            {.doc = "a node takes one scan per period of presence", .unit = "s", .min = 1e-3});
    v.field("travel_m", c.travel_m,
            {.doc = "... or one per this much travel", .unit = "m", .min = 1e-3});
    v.field("turn_rad", c.turn_rad,
            {.doc = "... or one per this much turning", .unit = "rad", .min = 1e-3});
    v.field("warm_up", c.warm_up,
            {.doc = "slow levels fill from the first observations of a node",
             .preset = {"paper-timescale", "false"}});
    v.field("coupled_eviction", c.coupled_eviction,
            {.doc = "a sample that leaves takes a pair along, as in the paper",
             .preset = {"paper-timescale", "true"}});
    v.group("visibility", c.visibility, "what of a scan a node can see");
    v.list("levels", c.levels, "time levels, the first forgets fastest");
    require_consistent(c, v);
  }

 private:
  template <class Self, class V>
  static void require_consistent(Self& c, V& v) {
    v.require(c.update_radius_m <= c.node_spacing_m, "update_radius_m",
              "is larger than node_spacing_m", "lower it");
    v.require(!c.levels.empty(), "levels", "has no level", "give at least one");
    std::set<std::string> names;
    for (const LevelConfig& level : c.levels) {
      v.require(names.insert(level.name).second, "levels", "has '" + level.name + "' twice",
                "give each level its own name");
      // A hundredth to spare: 3.1 s with five samples asks for 1.002.
      const bool is_fast = !level.learns_by_days();
      v.require(!is_fast || level.insertion_probability(c.period_s) <= 1.01, "levels",
                "'" + level.name + "' forgets faster than one new sample per observation can",
                "lower its samples or raise its half_life_s");
    }
  }
};

/// The experiment of [kessler2010what, section 5]: 3 m across, 20 range bins of 7.5 cm, pairs leave
/// with samples. Decode with `paper_decoding`.
[[nodiscard]] inline TimescaleConfig paper_timescale_config() {
  TimescaleConfig config;
  config.range_bins = 20;
  config.max_range_m = 1.5;
  config.visibility.fill_between_beams = false;
  config.warm_up = false;
  config.coupled_eviction = true;
  return config;
}

}  // namespace strata::memory
