// SPDX-License-Identifier: Apache-2.0
/// What a shard of a comparison leaves, and the comparison that all of them make.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/comparison_report.hpp"
#include "tools/shards/shard_folder.hpp"

namespace strata::pipeline {

/// A building as far as a shard knows it.
struct BuildingShard {
  std::string folder;              ///< of its own report, below the joint one; empty: the only one
  std::vector<Comparison> splits;  ///< SplitOutcomes::splits
  bool has_figures = false;        ///< the maps of its first split were learned with scores
  MapFigures figures;
};

struct ComparisonShard {
  std::string settings;  ///< as the report shows them
  std::vector<BuildingShard> buildings;
};

/// Where a shard keeps the files of a building's figures.
[[nodiscard]] std::filesystem::path figures_folder(const std::filesystem::path& shard,
                                                   std::size_t building);

/// Into a folder that is there. Throws OutputError.
void write_comparison_shard(const shards::ShardInfo& info, const ComparisonShard& shard,
                            const std::filesystem::path& folder);
/// Throws InputError, DamageError.
[[nodiscard]] ComparisonShard read_comparison_shard(const std::filesystem::path& folder);

struct MergedReport {
  nlohmann::json json;  ///< comparison.json
  std::string verdict;
};
/// Writes the reports that one machine would have written into `folder`: the same bits but for
/// times. shards: all of a job, in order. Throws InputError, DamageError, OutputError.
[[nodiscard]] MergedReport merge_comparison(const std::vector<shards::ShardFolder>& shards,
                                            const std::filesystem::path& folder);

}  // namespace strata::pipeline
