// SPDX-License-Identifier: Apache-2.0
/// Learning that some cells are kept from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/grid/metric_polygon.hpp"
#include "core/grid/surface_layer.hpp"
#include "tools/pipeline/learn.hpp"

namespace strata::pipeline {

/// What the map was before.
struct BaseBefore {
  ReflectionGrid occupancy;
  ReflectionGrid filtered;
  Grid<CellCounts> counts;
  SurfaceLayer surfaces;
};
/// Of a MAPS folder. Throws InputError.
[[nodiscard]] BaseBefore read_base(const std::filesystem::path& maps);

struct LearnWithin {
  Grid<std::uint8_t> never;        ///< 1: nothing of new runs is learned there
  Grid<std::uint8_t> static_only;  ///< 1: nothing is held to change there
  BaseBefore before;               ///< what cells of `never` keep; empty: unknown
  Grid<std::uint8_t> only = {};    ///< 1: there alone is learned; without cells: everywhere
  bool forgets = false;            ///< what earlier runs saw in cells of `only` counts no more
};

/// Cells whose middle a region contains, for LearnWithin::only. Throws InputError (place: the
/// region's file) where there are none, or more than 40 million.
[[nodiscard]] Grid<std::uint8_t> cells_of_region(const std::vector<MetricPolygon>& region,
                                                 double resolution_m, const std::string& place);

/// As learn(), but: the grid maps are in cells of `never` bit for bit what they were before; beams
/// of new runs that end in or cross such cells serve to find poses and the grid maps elsewhere,
/// and are then invalid: for patches, the memory, and in the scans of the result, so that later
/// updates do not learn from them either. Where `only` has cells, all others are such cells. Beams
/// of earlier runs that saw what is forgotten become invalid likewise; what the memory knows of it
/// stays until new runs have seen it. Without cells it is learn(), bit for bit.
/// Throws InputError where `before` has cells of another size than config, and as learn().
[[nodiscard]] LearnResult learn_within(const LearnWithin& limits,
                                       const std::vector<Observation>& observations,
                                       const std::vector<std::optional<Pose2>>& given_poses,
                                       const maps::LearnConfig& config, const LearnParts& parts,
                                       std::uint64_t seed, int threads, Progress* progress,
                                       maps::EarlierRuns* earlier);

}  // namespace strata::pipeline
