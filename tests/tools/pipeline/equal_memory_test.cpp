// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/equal_memory.hpp"

#include <gtest/gtest.h>

#include "tests/tools/pipeline/simulated_room.hpp"

namespace strata::pipeline {
namespace {

ModelResult model_of(const std::string& name, const std::vector<std::size_t>& sizes) {
  ModelResult model;
  model.model = name;
  for (const std::size_t bytes : sizes) {
    model.memory.push_back({std::to_string(bytes), bytes, {0.1}, 0});
  }
  return model;
}

TEST(EqualMemory, GivesEachModelTheLargestMapThatFits) {
  Comparison comparison;
  comparison.models = {model_of("occupancy", {1000, 250}), model_of("patch", {1050, 300}),
                       model_of("timescale", {50000, 5000, 2000}), model_of("map", {})};
  const std::vector<MemoryBudget> budgets = equal_memory(comparison);
  ASSERT_EQ(budgets.size(), 2U);  // 1000 and 1050 are alike
  EXPECT_EQ(budgets[0].bytes, 1050U);
  EXPECT_EQ(budgets[0].points[0]->bytes, 1000U);
  EXPECT_EQ(budgets[0].points[1]->bytes, 1050U);
  EXPECT_EQ(budgets[0].points[2], nullptr);
  EXPECT_EQ(budgets[0].points[3], nullptr);
  EXPECT_EQ(budgets[1].bytes, 50000U);
  EXPECT_EQ(budgets[1].points[2]->bytes, 50000U);
}

/// One count from the beginning to the end, so that the time left is that of the whole job.
struct OneCount : Progress {
  std::size_t done = 0;
  std::size_t total = 0;
  void update(std::string_view stage, std::size_t now, std::size_t of) override {
    EXPECT_EQ(stage, "compare");
    EXPECT_GE(now, done);
    EXPECT_TRUE(total == 0 || of == total);
    done = now;
    total = of;
  }
};

TEST(EqualMemory, CurvesBeginWithTheRunsAtFullMemoryAndShrink) {
  const Runs runs = test_room::simulate_located_runs(2, 2);
  CompareConfig config;
  config.protocol.models = {"occupancy", "timescale_mixture"};
  config.protocol.memory_seeds = 3;
  CompareJob job;
  job.splits = make_folds(runs, {"one", "two"}, 2);
  job.seeds = {1, 2, 3};
  job.jobs = 2;
  OneCount progress;
  job.progress = &progress;
  const Comparison comparison = compare(runs, config, job).comparison;
  for (const ModelResult& model : comparison.models) {
    ASSERT_EQ(model.memory.size(), 3U) << model.model;
    EXPECT_EQ(model.memory[0].bytes, model.map_bytes);
    for (std::size_t step = 0; step < 3; ++step) {
      ASSERT_EQ(model.memory[step].run_means_m.size(),
                4U);  // three runs over two drives: two of each
      if (step == 0) continue;
      EXPECT_LT(2 * model.memory[step].bytes, model.memory[step - 1].bytes);
    }
    EXPECT_EQ(model.memory[0].run_means_m[1], model.runs[1].metrics.error_m.mean);
    EXPECT_EQ(model.memory[0].run_means_m[2], model.runs[3].metrics.error_m.mean);
  }
  // Two drives, two models, three seeds; at two steps less memory two seeds.
  EXPECT_EQ(progress.total, 12U + 16U);
  EXPECT_EQ(progress.done, progress.total);
}

}  // namespace
}  // namespace strata::pipeline
