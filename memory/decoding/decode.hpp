// SPDX-License-Identifier: Apache-2.0
/// The scan that a level of a node expects [kessler2010what, section 4].
#pragma once

#include <vector>

#include "memory/decoding/decoding_config.hpp"
#include "memory/levels/node_level.hpp"

namespace strata::memory {

/// One range per angle bin: a value that was measured; +Inf for "at least max_range_m"; -f where
/// the way is free to f and nobody saw what comes then; NaN where nothing was ever seen.
struct DecodedScan {
  std::vector<float> range_m;
  double cost = 0.0;
  /// No closed path joins the bins: each bin shows its most frequent range bin by itself.
  bool inconsistent = false;
};

/// The cheapest closed path through the level's range bins; per bin the lower median of the samples
/// in the chosen range bin (the lower of two, so that it was measured). Milliseconds at most.
[[nodiscard]] DecodedScan decode(const NodeLevel& level, const DecodingConfig& config);

/// The median of each angle bin by itself, which [kessler2010what] improves on: neighbours may
/// contradict each other. For comparison.
[[nodiscard]] std::vector<float> decode_per_bin_median(const NodeLevel& level);

}  // namespace strata::memory
