// SPDX-License-Identifier: Apache-2.0
// Comparisons that several machines share.
#include <numeric>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"
#include "tools/pipeline/comparison_shard.hpp"
#include "tools/pipeline/comparison_state.hpp"
#include "tools/pipeline/join_comparisons.hpp"
#include "tools/pipeline/shard_plan.hpp"

namespace strata::pipeline {
namespace {

ComparisonSize size_of(std::size_t buildings, std::size_t splits, std::size_t seeds) {
  ComparisonSize size{buildings, splits, std::vector<std::uint64_t>(seeds)};
  std::iota(size.seeds.begin(), size.seeds.end(), 11);
  return size;
}

TEST(ShardPlan, GivesEachSeedOfEachSplitToOneShardAndScoresWithTheFirstOnes) {
  const CompareConfig config;
  const ComparisonSize size = size_of(2, 3, 20);
  const std::size_t first = seeds_for_scores(config, 20);
  EXPECT_EQ(first, 5U);
  for (const int count : {1, 2, 7, 200}) {
    std::map<std::pair<std::size_t, std::size_t>, std::multiset<std::uint64_t>> seeds;
    std::size_t scored = 0;
    for (int index = 1; index <= count; ++index) {
      const auto plan = plan_shard(size, config, {index, count});
      for (std::size_t b = 0; b < 2; ++b) {
        for (std::size_t s = 0; s < 3; ++s) {
          const SplitShare& share = plan[b][s];
          seeds[{b, s}].insert(share.seeds.begin(), share.seeds.end());
          if (!share.with_scores) continue;
          ++scored;
          ASSERT_GE(share.seeds.size(), first);
          EXPECT_TRUE(std::equal(size.seeds.begin(), size.seeds.begin() + 5, share.seeds.begin()));
        }
      }
    }
    EXPECT_EQ(scored, 6U);
    for (const auto& [split, all] : seeds) {
      EXPECT_EQ(all, std::multiset<std::uint64_t>(size.seeds.begin(), size.seeds.end()));
    }
  }
}

/// Everything of a comparison but times, as bytes.
std::vector<std::uint8_t> bytes_of(Comparison comparison) {
  for (ModelResult& model : comparison.models) {
    for (ModelRun& run : model.runs) run.update_ms.clear();
    for (PredictionScore& score : model.scores) score.query_ms.clear();
  }
  // Field by field: the padding of plain structs is anything.
  const nlohmann::json json = to_json(comparison, paired_tests(comparison));
  StateWriter write;
  write(json.dump());
  for (const ModelResult& model : comparison.models) {
    for (const ModelRun& run : model.runs) {
      write(run.part);
      write(run.seed);
      write(run.estimates);
      for (const ScanError& error : run.errors) write(error.error_m);
    }
    write(model.states.size());
    for (const StateTrace& trace : model.states) write(trace.probability);
  }
  return write.take();
}

TEST(Shards, OfAComparisonMergeToTheSameBits) {
  const Runs runs = test_room::simulate_located_runs(2, 2);
  CompareConfig config;
  config.protocol.models = {"occupancy", "patch"};
  config.protocol.memory_steps = 1;
  config.protocol.memory_seeds = 2;
  CompareJob job;
  job.splits = make_folds(runs, {"one", "two"}, 2);
  job.seeds = {11, 12, 13, 14, 15};
  job.jobs = 2;
  const std::vector<std::uint8_t> whole = bytes_of(compare(runs, config, job).comparison);
  std::vector<std::vector<Comparison>> of_split(2);
  for (int index = 1; index <= 3; ++index) {
    job.shares = plan_shard({1, 2, job.seeds}, config, {index, 3})[0];
    SplitOutcomes outcomes = compare_splits(runs, config, job);
    for (std::size_t s = 0; s < 2; ++s) {
      if (!outcomes.splits[s].parts.empty()) of_split[s].push_back(std::move(outcomes.splits[s]));
    }
  }
  EXPECT_GT(of_split[0].size() + of_split[1].size(), 2U);
  std::vector<Comparison> splits;
  for (auto& shares : of_split) splits.push_back(join_seeds(std::move(shares), "a test"));
  EXPECT_EQ(bytes_of(join_splits(std::move(splits))), whole);
}

TEST(Shards, ThatDoNotFitAreRefused) {
  Comparison scored;
  scored.seeds = 2;
  scored.parts.resize(1);
  scored.models.resize(1);
  scored.models[0].scores.resize(1);
  scored.models[0].runs.resize(1);
  Comparison other = scored;
  other.models[0].scores.clear();
  other.models[0].runs[0].seed = 1;
  EXPECT_EQ(join_seeds({other, scored}, "here").models[0].runs[1].seed, 1U);
  const auto refuses = [&](std::vector<Comparison> shares) {
    EXPECT_THROW(static_cast<void>(join_seeds(std::move(shares), "here")), InputError);
  };
  refuses({scored});          // a seed is missing
  refuses({scored, scored});  // two with scores
  refuses({other, other});    // none
  Comparison twice = other;
  twice.models[0].runs[0].seed = 0;
  refuses({scored, twice});
  other.models[0].model = "another";
  refuses({scored, other});
}

TEST(Shards, AreReadAsTheyWereWritten) {
  ComparisonShard shard{"a: 1\n", {}};
  BuildingShard building{"1_office", {}, true, {"<p>maps</p>", "<p>times</p>"}};
  Comparison comparison;
  comparison.log = "week.clf";
  comparison.truth = TruthKind::kJointTrajectory;
  comparison.parts.resize(1);
  comparison.parts[0].changes.push_back({1.5, {2.0, 3.0}, 4, true, 0.5});
  comparison.models.resize(1);
  comparison.models[0].runs.resize(1);
  comparison.models[0].runs[0].errors.push_back({Stamp{7}, 0.1, 0.2, 0.3});
  comparison.models[0].runs[0].old_state_error_m = 0.25;
  comparison.models[0].memory.push_back({"half", 10, {0.1, 0.2}, 1});
  building.splits = {comparison, {}};
  shard.buildings.push_back(building);
  const test::TemporaryDirectory dir;
  write_comparison_shard(shards::shard_info("a test", {1, 1}, "1"), shard, dir.path());
  const ComparisonShard read = read_comparison_shard(dir.path());
  EXPECT_EQ(read.settings, "a: 1\n");
  ASSERT_EQ(read.buildings.size(), 1U);
  EXPECT_EQ(read.buildings[0].figures.timescale, "<p>times</p>");
  ASSERT_EQ(read.buildings[0].splits.size(), 2U);
  const Comparison& same = read.buildings[0].splits[0];
  EXPECT_EQ(same.truth, TruthKind::kJointTrajectory);
  EXPECT_EQ(same.parts[0].changes[0].center_m.y(), 3.0);
  EXPECT_EQ(same.models[0].runs[0].errors[0].score, 0.3);
  EXPECT_EQ(same.models[0].runs[0].old_state_error_m, 0.25);
  EXPECT_EQ(same.models[0].memory[0].run_means_m, (std::vector<double>{0.1, 0.2}));
}

}  // namespace
}  // namespace strata::pipeline
