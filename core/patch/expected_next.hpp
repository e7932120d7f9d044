// SPDX-License-Identifier: Apache-2.0
/// Which configuration a map that shows one only should show.
#pragma once

#include <vector>

#include "core/patch/patch_map.hpp"

namespace strata::patch {

/// The runs that are asked.
inline constexpr int kRunsAsked = 5;

/// Of each sub-map the configuration to expect at the next run: of those that the last kRunsAsked
/// runs saw, the one that differs from what these saw in the fewest cells, summed over their
/// sequences (their medoid); of equals the one seen last. So something that was moved for good
/// shows as soon as most of these runs saw it there, whatever a door beside it did, and a thing
/// that moves to and fro shows where it mostly was. Sequences whose membership is nowhere above a
/// half say nothing; where none tells, it is the one of the greatest prior. Ours.
/// O(sequences log sequences + cells x configurations^2).
[[nodiscard]] std::vector<int> expected_next(const PatchMap& map);

}  // namespace strata::patch
