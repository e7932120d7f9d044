// SPDX-License-Identifier: Apache-2.0
/// From sequences of a sub-map to its configurations (docs/theory/patch_maps.md, "Configurations").
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_learner_config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/patch/region_growing.hpp"
#include "core/patch/sequence_history.hpp"

namespace strata::patch {

/// The sub-map of a region, its id not given yet: clusters what the sequences saw and pools their
/// counts by membership; configurations are in the order in which they were first seen. `infos`
/// says when each was made, `history` how often and after which (one entry each), counts_of(i) what
/// it counted on the region's rectangle (asked twice). Priors and the rate of change are those of
/// learn_chain(). Unknown cells of configurations come from `filtered`. Without a sequence that
/// knows enough there are no configurations. O(sequences x cells + clustering).
[[nodiscard]] Submap learn_configurations(
    const Region& region, std::span<const SequenceInfo> infos, const SequenceHistory& history,
    const std::function<Grid<CellCounts>(std::size_t)>& counts_of, const ReflectionGrid& filtered,
    const PatchLearnerConfig& config);

/// Appends the sub-maps with at least two configurations to the map (config may keep the others
/// too), with their ids. Those in which nothing returns are left out and named instead.
void keep_changing(std::vector<Submap> submaps, const PatchLearnerConfig& config, PatchMap& map);

}  // namespace strata::patch
