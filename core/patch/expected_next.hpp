// SPDX-License-Identifier: Apache-2.0
/// Which configuration a map that shows one only should show.
#pragma once

#include <vector>

#include "core/patch/patch_map.hpp"

namespace strata::patch {

/// Of so many runs it is asked which guess was right.
inline constexpr std::size_t kGuessedRuns = 8;

/// Of each sub-map the configuration to expect at the next run: the one of the greatest prior, or
/// the one seen last. Each run but the first tried both: what the run before saw last, and what the
/// runs before saw most often, of equals the one seen last, against what it saw first. Where the
/// former was right more often in the last kGuessedRuns runs, what was seen last is expected:
/// things there move for good, not to and fro. Sequences whose membership is nowhere above a half
/// say nothing. Ours. O(sequences x (configurations + log sequences)).
[[nodiscard]] std::vector<int> expected_next(const PatchMap& map);

}  // namespace strata::patch
