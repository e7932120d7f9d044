// SPDX-License-Identifier: Apache-2.0
/// From contradictory cells to sub-maps: regions are grown, and merged while they see each other
/// and stay small [stachniss2005patch, "Map Segmentation"] (docs/theory/patch_maps.md, "Regions").
#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::patch {

struct RegionConfig {
  double dilation_m = 0.3;
  double margin_m = 0.5;
  double max_gap_m = 3.0;
  double min_visible_share = 0.5;
  int visibility_samples = 50;
  double max_area_m2 = 20.0;
  std::vector<double> places;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("dilation_m", c.dilation_m,
            {.doc = "contradictory cells closer than twice this are one region",
             .unit = "m",
             .min = 0.0});
    v.field("margin_m", c.margin_m,
            {.doc = "a sub-map reaches this far beyond its contradictory cells",
             .unit = "m",
             .min = 0.0});
    v.field("max_gap_m", c.max_gap_m,
            {.doc = "regions farther apart are never merged", .unit = "m", .min = 0.0});
    v.field("min_visible_share", c.min_visible_share,
            {.doc = "share of sampled cell pairs that must see each other for a merge",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("visibility_samples", c.visibility_samples,
            {.doc = "cell pairs sampled at most", .min = 1});
    v.field("max_area_m2", c.max_area_m2,
            {.doc = "merging stops at this area of a sub-map", .unit = "m^2", .min = 0.0});
    v.field("places", c.places,
            {.doc = "x, y of each place of a topology, one after the other, in the map frame "
                    "(places.yaml of strata topology): then regions with the same nearest place "
                    "are one sub-map, however large; empty: merged by what they see of each other",
             .unit = "m"});
    v.require(c.places.size() % 2 == 0, "places", "has an x without a y",
              "give two numbers a place");
  }
};

/// One area of change.
struct Region {
  CellRect rect;            ///< bounds of the cells plus the margin
  std::vector<Cell> cells;  ///< its contradictory cells, in order of (y, x)
  /// A single connected region above the greatest area; kept, since cutting a changing object in
  /// two would make its halves look independent.
  bool oversized = false;
};

/// Connected components of the mask dilated by dilation_m (8-neighbours), before any merge.
/// O(cells of the mask + dilated area).
[[nodiscard]] std::vector<Region> grow_regions(const Grid<std::uint8_t>& contradictory,
                                               const RegionConfig& config);

/// Merges pairs whose gap is at most max_gap_m and that see each other in the static map, the pair
/// with the smallest united rectangle first, while the united area stays within max_area_m2.
/// Unknown cells and the regions' own cells do not block the view (a closed door would hide
/// itself). Result ordered by rectangle (min y, then min x). O(p^2 log p) for p regions
/// [stachniss2005patch].
[[nodiscard]] std::vector<Region> merge_regions(std::vector<Region> regions,
                                                const ReflectionGrid& static_map,
                                                const RegionConfig& config);

/// Regions whose middles have the same place of config.places nearest become one: the sub-maps
/// follow the places of a topology, which [stachniss2005patch] names as future work. Ordered as
/// above. Requires a place. O(regions x places).
[[nodiscard]] std::vector<Region> group_by_places(std::vector<Region> regions, double resolution_m,
                                                  const RegionConfig& config);

/// group_by_places where the config names places, else merge_regions.
[[nodiscard]] std::vector<Region> join_regions(std::vector<Region> regions,
                                               const ReflectionGrid& static_map,
                                               const RegionConfig& config);

/// Whether at least min_visible_share of the sampled cell pairs see each other.
[[nodiscard]] bool see_each_other(const Region& a, const Region& b,
                                  const ReflectionGrid& static_map,
                                  const Grid<std::uint8_t>& transparent,
                                  const RegionConfig& config);

}  // namespace strata::patch
