// SPDX-License-Identifier: Apache-2.0
/// Which shard of a comparison does what (docs/comparing.md, "Several machines").
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/pipeline/compare.hpp"
#include "tools/shards/shard.hpp"

namespace strata::pipeline {

/// A whole comparison, before any log was read.
struct ComparisonSize {
  std::size_t buildings = 1;
  std::size_t splits = 1;  ///< of each
  std::vector<std::uint64_t> seeds;
};

/// What the shard does: of each building, of each of its splits. A split's scores go with the first
/// seeds, the ones that they need; each of the other seeds may be another shard's.
[[nodiscard]] std::vector<std::vector<SplitShare>> plan_shard(const ComparisonSize& size,
                                                              const CompareConfig& config,
                                                              const shards::Shard& shard);

}  // namespace strata::pipeline
