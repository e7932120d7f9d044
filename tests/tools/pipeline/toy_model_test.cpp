// SPDX-License-Identifier: Apache-2.0
/// A map model that is only registered is localized with and compared as any other.
#include "tests/components/maps/toy_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"
#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/online_predictor.hpp"

namespace strata::pipeline {
namespace {

using strata::test::same_bits;

// The toy is the occupancy grid under another name: so must be every number.
TEST(ToyModel, IsComparedByItsRegistrationAlone) {
  Runs runs = test_room::simulate_runs(2, 2);
  runs.poses = runs.truths;
  const maps::MapModels models = maps::test_room::with_toy();
  CompareConfig config;
  config.protocol.models = {"occupancy", "toy"};
  config.protocol.memory_steps = 1;
  CompareJob job;
  job.map_models = &models;
  job.splits = {split_by_time(runs, "room", 0.6 * elapsed_seconds(runs.observations).back())};
  job.seeds = {1, 2};
  job.jobs = 2;
  const CompareOutcome outcome = compare(runs, config, job);
  ASSERT_EQ(outcome.comparison.models.size(), 2U);
  const ModelResult& grid = outcome.comparison.models[0];
  const ModelResult& toy = outcome.comparison.models[1];
  EXPECT_EQ(toy.model, "toy");
  ASSERT_EQ(toy.runs.size(), 2U);
  for (std::size_t r = 0; r < toy.runs.size(); ++r) {
    ASSERT_FALSE(toy.runs[r].errors.empty());
    ASSERT_EQ(toy.runs[r].errors.size(), grid.runs[r].errors.size());
    for (std::size_t i = 0; i < toy.runs[r].errors.size(); ++i) {
      ASSERT_EQ(toy.runs[r].errors[i].error_m, grid.runs[r].errors[i].error_m) << i;
    }
  }
  EXPECT_EQ(toy.scores.at(0).overall.log_likelihood_per_beam,
            grid.scores.at(0).overall.log_likelihood_per_beam);
  ASSERT_EQ(toy.memory.size(), 2U);
  EXPECT_EQ(toy.memory[1].setting, grid.memory[1].setting);

  // It shows the map to plan in, and is localized with by itself.
  const maps::MapModel made = maps::make_map_model(outcome.maps, "toy", {}, models);
  const auto watcher = make_online_predictor(outcome.maps, made, {});
  ASSERT_NE(watcher->map(), nullptr);
  EXPECT_TRUE(same_bits(*watcher->map(), outcome.maps.occupancy));
  const Pose2Gaussian start{*runs.truths.front(), Eigen::Matrix3d::Identity() * 1e-4};
  const LocalizationRun run = localize(runs.observations, runs.truths, made, outcome.maps.filtered,
                                       {}, {start}, 1, 1, nullptr);
  EXPECT_EQ(run.trajectory.size(), runs.observations.size());
}

TEST(ToyModel, IsRefusedBeforeLearningWhereItIsNotRegistered) {
  const Runs runs = test_room::simulate_runs(2, 1);
  CompareConfig config;
  config.protocol.models = {"toy"};
  CompareJob job;
  job.seeds = {1};
  job.splits = {split_by_time(runs, "room", 0.6 * elapsed_seconds(runs.observations).back())};
  try {
    (void)compare(runs, config, job);
    ADD_FAILURE() << "taken";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("occupancy, filtered, patch, patch_paper"));
  }
}

}  // namespace
}  // namespace strata::pipeline
