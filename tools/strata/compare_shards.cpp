// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/compare_shards.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <utility>
#include <vector>

#include "components/settings/settings.hpp"
#include "tools/pipeline/comparison_replay.hpp"
#include "tools/pipeline/comparison_shard.hpp"
#include "tools/pipeline/drive_replay.hpp"
#include "tools/pipeline/shard_plan.hpp"
#include "tools/report/drawings.hpp"
#include "tools/shards/shard_folder.hpp"
#include "tools/strata/compare_inputs.hpp"
#include "tools/strata/compare_job.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/warning.hpp"

namespace strata::tools {
namespace {

/// The shard's part of one building, its figures below `folder`.
pipeline::BuildingShard compare_shard_of(const CompareOptions& options, std::size_t building,
                                         const pipeline::RunsInput& input,
                                         const std::vector<pipeline::SplitShare>& shares,
                                         const pipeline::CompareConfig& config,
                                         const std::filesystem::path& folder,
                                         report::Drawings& drawings, VerbContext& context) {
  PreparedComparison prepared = prepare_comparison(options, input, config, context);
  prepared.job.shares = shares;
  pipeline::SplitOutcomes outcomes = pipeline::compare_splits(prepared.runs, config, prepared.job);
  pipeline::BuildingShard shard;
  shard.splits = std::move(outcomes.splits);
  shard.has_figures = shares.front().with_scores;
  if (shard.has_figures) {
    const std::filesystem::path own = pipeline::figures_folder(folder, building);
    std::filesystem::create_directories(own);
    shard.figures = pipeline::draw_maps(outcomes.learned, outcomes.maps, own, &drawings);
    drawings.add(own / pipeline::kReplayPage, [&] {
      pipeline::write_comparison_replay(shard.splits.front(), outcomes.maps, outcomes.drive, own);
    });
  }
  return shard;
}

}  // namespace

void compare_shard(const CompareOptions& options, const pipeline::CompareConfig& config,
                   VerbContext& context) {
  const shards::Shard own = shards::parse_shard(options.shard);
  ResultDirectory out(options.out, "a shard", context);
  pipeline::ComparisonSize size;
  size.buildings = options.buildings ? options.input.logs.size() : 1;
  size.splits = static_cast<std::size_t>(std::max(1, options.folds));
  size.seeds = seeds_of(options, context.options.seed);
  const auto plan = pipeline::plan_shard(size, config, own);
  pipeline::ComparisonShard shard{settings::write_yaml(config), {}};
  shards::ShardInfo info = shard_info_of(options, shard.settings, own, context);
  report::Drawings drawings;
  for (std::size_t b = 0; b < size.buildings; ++b) {
    const bool has_work = std::any_of(plan[b].begin(), plan[b].end(),
                                      [](const auto& share) { return !share.seeds.empty(); });
    const pipeline::RunsInput input =
        options.buildings ? building_input(options, b) : input_of(options);
    pipeline::BuildingShard building;
    building.splits.resize(size.splits);
    if (has_work) {
      add_inputs(input, b, info);
      building =
          compare_shard_of(options, b, input, plan[b], config, out.path(), drawings, context);
    }
    if (options.buildings) building.folder = building_folder(options, b);
    shard.buildings.push_back(std::move(building));
  }
  pipeline::write_comparison_shard(info, shard, out.path());
  out.commit();
  warn(context, drawings.what_is_missing());
  context.note("shard " + options.shard + ": " + options.out);
}

void merge_shards(const CompareOptions& options, VerbContext& context) {
  ResultDirectory out(options.out, "comparison", context);
  const auto folders = shards::read_all_shards(options.merge, kCompareJob, STRATA_VERSION);
  const pipeline::MergedReport report = pipeline::merge_comparison(folders, out.path());
  out.commit();
  std::cout << (options.json ? report.json.dump(2) : report.verdict) << '\n';
}

}  // namespace strata::tools
