// SPDX-License-Identifier: Apache-2.0
/// Which configuration a map that shows one only should show.
#pragma once

#include <vector>

#include "core/patch/patch_map.hpp"

namespace strata::patch {

/// So many runs in a row must have seen nothing that was there before: fewer are chance where few
/// days were seen.
inline constexpr int kRunsToSettle = 3;

/// Of each sub-map the configuration of the greatest prior; but where it has changed for good the
/// one that was seen most often since, of equals the one seen last. It has when from some sequence
/// on, which may be in the middle of a run, only configurations were seen that were not seen
/// before, in kRunsToSettle runs or more; of several such the last. Sequences whose membership is
/// nowhere above a half say nothing. Ours. O(sequences x (configurations + log sequences)).
[[nodiscard]] std::vector<int> usual_now(const PatchMap& map);

}  // namespace strata::patch
