// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/shard_plan.hpp"

namespace strata::pipeline {
namespace {

/// Learning and scoring a split take about as long as this many seeds.
constexpr double kScoresInSeeds = 4.0;

}  // namespace

std::vector<std::vector<SplitShare>> plan_shard(const ComparisonSize& size,
                                                const CompareConfig& config,
                                                const shards::Shard& shard) {
  const std::size_t first = seeds_for_scores(config, size.seeds.size());
  const std::size_t units = 1 + size.seeds.size() - first;  // of each split
  const double smaller_maps = config.protocol.memory_steps;
  std::vector<double> weights;
  for (std::size_t i = 0; i < size.buildings * size.splits * units; ++i) {
    const bool is_first = i % units == 0;
    weights.push_back(is_first ? static_cast<double>(first) * (1.0 + smaller_maps) + kScoresInSeeds
                               : 1.0);
  }
  const std::vector<int> owner = shards::owners(weights, shard.count);
  std::vector<std::vector<SplitShare>> plan(size.buildings,
                                            std::vector<SplitShare>(size.splits, {{}, false}));
  for (std::size_t i = 0; i < owner.size(); ++i) {
    if (owner[i] != shard.index) continue;
    const std::size_t split = i / units;
    SplitShare& share = plan[split / size.splits][split % size.splits];
    const std::size_t unit = i % units;
    if (unit > 0) {
      share.seeds.push_back(size.seeds[first + unit - 1]);
      continue;
    }
    share.seeds.assign(size.seeds.begin(), size.seeds.begin() + static_cast<std::ptrdiff_t>(first));
    share.with_scores = true;
  }
  return plan;
}

}  // namespace strata::pipeline
