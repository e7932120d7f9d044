// SPDX-License-Identifier: Apache-2.0
/// What one beam says when it may end at several places.
#pragma once

#include <span>

#include "core/localization/patch_states.hpp"
#include "core/patch_beams/patch_ray_caster.hpp"

namespace strata::patch_beams {

/// p(z) of one beam when sub-map s is in configuration k with probability belief[offset(s) + k],
/// independently of others, exactly (docs/theory/patch_localization.md, "Beams through sub-maps").
/// Each event counts with the probability that its configuration holds and no earlier one ended the
/// beam. fixed_submap >= 0: that one is known to be in fixed_patch. end_value: the value of a beam
/// that meets nothing. values[e] is what event e contributes. O(events^2).
[[nodiscard]] double mix_events(std::span<const RayEvent> events, std::span<const double> values,
                                double end_value, const localization::PatchStates& states,
                                std::span<const float> belief, int fixed_submap = -1,
                                int fixed_patch = -1);

}  // namespace strata::patch_beams
