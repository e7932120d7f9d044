// SPDX-License-Identifier: Apache-2.0
/// The mask of what often changes, as nav2's costmap filters take it (docs/nav2.md).
#pragma once

#include <span>
#include <vector>

#include "components/localizer/current_map_config.hpp"
#include "components/maps/map_models.hpp"
#include "components/site/zone_masks.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/particle_set.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch/map_now.hpp"

namespace strata::localizer {

/// Whether maps of this model have areas that change.
[[nodiscard]] bool has_change_mask(const maps::MapModelDescriptor& model);

/// What the filter knows of its sub-maps' chains, with what is believed of them now: one entry a
/// sub-map of both. usual: of all columns of the states. O(columns).
[[nodiscard]] std::vector<patch::SubmapOutlook> outlook_of(
    const localization::PatchStates& states, std::span<const float> usual,
    const std::vector<patch::Shares>& beliefs);

/// The probabilities of change as the filter of that kind takes them, as parts of 1. Penalty:
/// times max_penalty; unknown, which KeepoutFilter passes over, where nothing is to be added and
/// where the map is unknown, since anything else would make unknown cells passable. Speed: as they
/// are, 0 for no limit; SpeedFilter cannot take unknown cells. Requires both on the same cells.
[[nodiscard]] ReflectionGrid mask_of(const Grid<float>& change, const ReflectionGrid& occupied,
                                     const ChangeMaskConfig& config);

/// What the mask's percent mean: KeepoutFilter wants base 0 and multiplier 1; to SpeedFilter value
/// v is a limit of base + multiplier v percent, of which 100 makes min_speed. Not for kOff.
[[nodiscard]] site::FilterMeaning meaning_of(const ChangeMaskConfig& config);

}  // namespace strata::localizer
