// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_shard.hpp"

#include <algorithm>
#include <utility>

#include "core/base/error.hpp"
#include "tools/pipeline/comparison_state.hpp"
#include "tools/pipeline/join_comparisons.hpp"
#include "tools/pipeline/several_buildings.hpp"

namespace fs = std::filesystem;

namespace strata::pipeline {

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, BuildingShard>
void state_of(Value& building, Archive& archive) {
  archive(building.folder);
  archive(building.splits);
  archive(building.has_figures);
  archive(building.figures.grids_and_patches);
  archive(building.figures.timescale);
}

namespace {

void copy_figures(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to, error);
  if (!error) fs::copy(from, to, fs::copy_options::recursive, error);
  if (error) throw OutputError(to.string(), error.message(), "choose another --out");
}

/// The seeds of one split, from all shards that have some of them.
Comparison join_split(std::vector<ComparisonShard>& shards, std::size_t building, std::size_t split,
                      const std::string& place) {
  std::vector<Comparison> shares;
  for (ComparisonShard& shard : shards) {
    Comparison& share = shard.buildings[building].splits[split];
    if (!share.parts.empty()) shares.push_back(std::move(share));
  }
  return join_seeds(std::move(shares), place);
}

}  // namespace

fs::path figures_folder(const fs::path& shard, std::size_t building) {
  return shard / ("figures_" + std::to_string(building + 1));
}

void write_comparison_shard(const shards::ShardInfo& info, const ComparisonShard& shard,
                            const fs::path& folder) {
  StateWriter write;
  write(shard.settings);
  write(shard.buildings);
  shards::write_shard(info, write.take(), folder);
}

ComparisonShard read_comparison_shard(const fs::path& folder) {
  const log::Bytes bytes = shards::read_shard_results(folder);
  StateReader read(bytes, (folder / shards::kShardResults).string());
  ComparisonShard shard;
  read(shard.settings);
  read(shard.buildings);
  read.expect_end();
  return shard;
}

MergedReport merge_comparison(const std::vector<shards::ShardFolder>& folders,
                              const fs::path& folder) {
  std::vector<ComparisonShard> all;
  for (const shards::ShardFolder& shard : folders) {
    all.push_back(read_comparison_shard(shard.path));
    bool fits = all.back().buildings.size() == all.front().buildings.size();
    for (std::size_t b = 0; fits && b < all.front().buildings.size(); ++b) {
      fits = all.back().buildings[b].splits.size() == all.front().buildings[b].splits.size();
    }
    if (!fits) throw InputError(shard.path.string(), "does not fit the others", "run it again");
  }
  const std::string settings = all.front().settings;
  std::vector<Building> buildings;
  for (std::size_t b = 0; b < all.front().buildings.size(); ++b) {
    const BuildingShard& like = all.front().buildings[b];
    Building building{like.folder, {}};
    std::vector<Comparison> splits;
    for (std::size_t s = 0; s < like.splits.size(); ++s) {
      splits.push_back(join_split(all, b, s, folders.front().path.parent_path().string()));
    }
    building.comparison = join_splits(std::move(splits));
    const fs::path own = building.folder.empty() ? folder : folder / building.folder;
    MapFigures figures;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!all[i].buildings[b].has_figures) continue;
      figures = all[i].buildings[b].figures;
      copy_figures(figures_folder(folders[i].path, b), own);
    }
    write_report(building.comparison, figures, settings, own);
    buildings.push_back(std::move(building));
  }
  if (buildings.front().folder.empty()) {
    const Comparison& only = buildings.front().comparison;
    const std::vector<PairedTest> tests = paired_tests(only);
    return {to_json(only, tests), verdict(only, tests)};
  }
  write_joint_report(buildings, settings, folder);
  const Comparison joint = join(buildings);
  return {joint_json(buildings), verdict(joint, paired_tests(joint))};
}

}  // namespace strata::pipeline
