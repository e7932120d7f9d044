// SPDX-License-Identifier: Apache-2.0
/// The patch map: a static base map, and for each changeable area the configurations that recur
/// there [stachniss2005patch, section III; stachniss2003chapter, section 1.3].
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/periodic/periodic_shares.hpp"

namespace strata::patch {

/// One observation sequence (1.16): the scans of one stay near a sub-map.
struct SequenceInfo {
  int run = 0;
  Stamp begin;
  Stamp end;
  std::size_t scans = 0;
  /// P(configuration c | this sequence) per configuration of the sub-map; sums to 1.
  std::vector<double> membership;
};

/// One recurring state of a sub-map. Both grids cover exactly the sub-map's rectangle.
struct Configuration {
  Grid<CellCounts> counts;    ///< evidence pooled over the sequences, weighted by membership
  ReflectionGrid reflection;  ///< what the sensor models use; unknown cells filled from the base
  /// The share of time that it is there, the stationary law of the sub-map's chain (core/patch/
  /// chain.hpp); sums to 1 over the sub-map.
  double prior = 0.0;
};

/// How often something other than what is usual came to a place, and how many different things.
struct Recurrence {
  double appearances = 0.0;  ///< of configurations but the most frequent one, after another
  double kinds = 0.0;        ///< of these, different ones
  /// The first thing that comes cannot have been there before.
  [[nodiscard]] double chances() const { return appearances > 1.0 ? appearances - 1.0 : 0.0; }
  [[nodiscard]] double returns() const { return appearances > kinds ? appearances - kinds : 0.0; }
  bool operator==(const Recurrence&) const = default;
};

/// A changeable area with its configurations.
struct Submap {
  int id = 0;
  CellRect rect;                     ///< on the lattice of the base map
  Grid<std::uint8_t> contradictory;  ///< 1 where observations of different visits contradict
  std::vector<Configuration> configurations;  ///< at least one
  std::vector<SequenceInfo> sequences;
  /// At which the configuration is drawn anew from the priors; 0: not known, but the sequences say
  /// something of it.
  double change_rate_per_s = 0.0;
  /// The shares by the time of day and week, a logit a configuration; not periodic: they are the
  /// priors at any time.
  periodic::PeriodicShares usual;
  /// As the learner counted it; of maps from elsewhere nobody knows.
  Recurrence recurrence = {};
};

/// Where a sub-map begins for a robot that enters it, unless settings say otherwise: a door is seen
/// from the corridor, whose middle its rectangle may not hold.
inline constexpr double kEntryMargin_m = 1.0;

/// base: the filtered static map everywhere (also under the sub-maps, as a fallback). Sub-maps may
/// overlap [stachniss2005patch]; ids are their places in the vector. entry_margin_m: from so far
/// around its rectangle a sub-map counts as entered, as when the map was learned.
struct PatchMap {
  ReflectionGrid base;
  std::vector<Submap> submaps;
  double entry_margin_m = kEntryMargin_m;
  /// Areas that change, but show nothing again, which the learner left out (core/patch/
  /// recurrence.hpp). Neither saved nor sent.
  std::vector<CellRect> unrecurring = {};
};

/// The sub-maps whose rectangle contains the cell, the one it belongs to first. The one rule for
/// overlaps: the nearest centre wins, of equally near ones the lower id. O(sub-maps).
[[nodiscard]] std::vector<std::size_t> submaps_at(const PatchMap& map, const Cell& cell);

/// The sub-map that a point belongs to: `current` while it contains the point, else the first of
/// submaps_at its cell; -1 for none. O(sub-maps), no allocation.
[[nodiscard]] int submap_at(const PatchMap& map, const Eigen::Vector2d& point_m, int current = -1);

/// The same for sub-maps that are entered from `reach_m` around them: where submap_at() says none,
/// `current` while its rectangle is within reach, else the nearest within reach, of equally near
/// ones the lower id. O(sub-maps), no allocation.
[[nodiscard]] int submap_in_reach(const PatchMap& map, const Eigen::Vector2d& point_m,
                                  double reach_m, int current = -1);

/// What configuration k of sub-map s says of a cell in its rectangle; where it knows nothing, what
/// the base says. Requires valid places.
[[nodiscard]] float reflection_at(const PatchMap& map, std::size_t s, std::size_t k,
                                  const Cell& cell);

/// The base map with the given configuration pasted into each sub-map (-1: leave the base). Where
/// sub-maps overlap, `current` wins, then the rule of submaps_at: the map that the sensor model
/// casts rays in. Requires one entry a sub-map. O(cells + cells of overlaps x sub-maps).
[[nodiscard]] ReflectionGrid compose(const PatchMap& map, const std::vector<int>& configurations,
                                     int current = -1);

}  // namespace strata::patch
