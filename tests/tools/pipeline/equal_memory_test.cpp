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

TEST(EqualMemory, CurvesBeginWithTheRunsAtFullMemoryAndShrink) {
  Runs runs = test_room::simulate_runs(2, 2);
  runs.poses = runs.truths;
  CompareConfig config;
  config.protocol.models = {"occupancy", "timescale_mixture"};
  config.protocol.memory_seeds = 2;
  CompareJob job;
  job.splits = make_folds(runs, {"one", "two"}, 2);
  job.seeds = {1, 2, 3};
  job.jobs = 2;
  const Comparison comparison = compare(runs, config, job).comparison;
  for (const ModelResult& model : comparison.models) {
    ASSERT_EQ(model.memory.size(), 3U) << model.model;
    EXPECT_EQ(model.memory[0].bytes, model.map_bytes);
    for (std::size_t step = 0; step < 3; ++step) {
      ASSERT_EQ(model.memory[step].run_means_m.size(), 4U);  // two drives, two of three seeds
      if (step == 0) continue;
      EXPECT_LT(2 * model.memory[step].bytes, model.memory[step - 1].bytes);
    }
    EXPECT_EQ(model.memory[0].run_means_m[1], model.runs[1].metrics.error_m.mean);
    EXPECT_EQ(model.memory[0].run_means_m[2], model.runs[3].metrics.error_m.mean);
  }
}

}  // namespace
}  // namespace strata::pipeline
