// SPDX-License-Identifier: Apache-2.0
/// Learning and localizing in a simulated room, as the verbs do it.

#include <gtest/gtest.h>

#include "tests/support/same_bits.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/localize.hpp"

namespace strata::pipeline {
namespace {

using strata::test::same_bits;

constexpr int kDays = 3;
constexpr std::uint64_t kDriveSeed = 5;

/// All days but the last.
std::vector<Observation> learning_part(const Runs& runs) {
  std::vector<Observation> part;
  for (const Observation& observation : runs.observations) {
    if (observation.run < kDays - 1) part.push_back(observation);
  }
  return part;
}

struct DirectPart {
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;  ///< in the learned map
  Pose2Gaussian start;
};

/// The last day, its truth brought into the learned map by one rigid motion over the other days.
DirectPart test_part(const Runs& runs, const LearnResult& learned) {
  const Pose2 map_from_truth = test_room::map_from_truth(runs, learned.slam.scans);
  DirectPart part;
  for (std::size_t i = learned.slam.scans.size(); i < runs.observations.size(); ++i) {
    part.observations.push_back(runs.observations[i]);
    part.truths.emplace_back(map_from_truth * *runs.truths[i]);
  }
  part.start.mean = *part.truths.front();
  part.start.covariance = Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal();
  return part;
}

maps::Maps maps_of(const LearnResult& learned) {
  maps::Maps maps;
  maps.occupancy = learned.slam.occupancy;
  maps.filtered = learned.slam.filtered;
  maps.patches = learned.patches;
  maps.timescale = learned.timescale;
  return maps;
}

LearnResult learn_days(const Runs& runs, int threads) {
  return learn(learning_part(runs), {}, {}, {}, kDriveSeed, threads, nullptr);
}

TEST(DirectPath, LocalizesWithEveryModelWithinTwentyCentimetres) {
  const Runs runs = test_room::simulate_runs(kDriveSeed, kDays);
  const LearnResult learned = learn_days(runs, 2);
  ASSERT_EQ(learned.slam.skipped_scans, 0U);
  ASSERT_EQ(learned.slam.scans.size(), learning_part(runs).size());
  const DirectPart part = test_part(runs, learned);
  const maps::Maps maps = maps_of(learned);
  for (const char* name : {"occupancy", "filtered", "patch", "timescale"}) {
    SCOPED_TRACE(name);
    const LocalizationRun run =
        localize(part.observations, part.truths, maps::make_map_model(maps, name, {}),
                 maps.filtered, {}, {part.start}, kDriveSeed, 2, nullptr);
    ASSERT_EQ(run.trajectory.size(), part.observations.size());
    ASSERT_EQ(run.errors.size(), part.observations.size());
    EXPECT_EQ(run.unusable_scans, 0U);
    EXPECT_LT(evaluate_run(run.errors).error_m.mean, 0.2);
  }
}

TEST(DirectPath, LearnsTheSameBitsWithAnyNumberOfThreads) {
  const Runs runs = test_room::simulate_runs(kDriveSeed, kDays);
  const LearnResult one = learn_days(runs, 1);
  for (const int threads : {2, 8}) {
    SCOPED_TRACE(threads);
    const LearnResult other = learn_days(runs, threads);
    ASSERT_EQ(other.slam.scans.size(), one.slam.scans.size());
    for (std::size_t i = 0; i < one.slam.scans.size(); ++i) {
      ASSERT_EQ(other.slam.scans[i].map_from_robot, one.slam.scans[i].map_from_robot) << i;
      ASSERT_EQ(other.slam.scans[i].static_probability, one.slam.scans[i].static_probability) << i;
    }
    EXPECT_EQ(other.slam.log_likelihood, one.slam.log_likelihood);
    EXPECT_TRUE(same_bits(other.slam.raw.cells().dense(), one.slam.raw.cells().dense()));
    EXPECT_TRUE(same_bits(other.slam.occupancy, one.slam.occupancy));
    EXPECT_TRUE(same_bits(other.slam.filtered, one.slam.filtered));
    EXPECT_TRUE(same_bits(other.patches.base, one.patches.base));
    ASSERT_EQ(other.patches.submaps.size(), one.patches.submaps.size());
    for (std::size_t s = 0; s < one.patches.submaps.size(); ++s) {
      const auto& expected = one.patches.submaps[s].configurations;
      const auto& configurations = other.patches.submaps[s].configurations;
      EXPECT_EQ(other.patches.submaps[s].rect, one.patches.submaps[s].rect);
      ASSERT_EQ(configurations.size(), expected.size());
      for (std::size_t c = 0; c < expected.size(); ++c) {
        EXPECT_TRUE(same_bits(configurations[c].counts, expected[c].counts));
        EXPECT_TRUE(same_bits(configurations[c].reflection, expected[c].reflection));
        EXPECT_EQ(configurations[c].prior, expected[c].prior);
      }
    }
    EXPECT_EQ(other.timescale->state(), one.timescale->state());
  }
}

TEST(DirectPath, LocalizesWithTheSameBitsWithAnyNumberOfThreads) {
  const Runs runs = test_room::simulate_runs(kDriveSeed, kDays);
  const LearnResult learned = learn_days(runs, 2);
  const DirectPart part = test_part(runs, learned);
  const maps::Maps maps = maps_of(learned);
  for (const char* name : {"filtered", "patch", "timescale"}) {
    const maps::MapModel model = maps::make_map_model(maps, name, {});
    const auto run_with = [&](int threads) {
      return localize(part.observations, part.truths, model, maps.filtered, {}, {part.start},
                      kDriveSeed, threads, nullptr);
    };
    const LocalizationRun one = run_with(1);
    for (const int threads : {2, 8}) {
      SCOPED_TRACE(std::string(name) + " with " + std::to_string(threads) + " threads");
      const LocalizationRun other = run_with(threads);
      ASSERT_EQ(other.errors.size(), one.errors.size());
      for (std::size_t i = 0; i < one.errors.size(); ++i) {
        ASSERT_EQ(other.trajectory[i].pose, one.trajectory[i].pose) << i;
        ASSERT_EQ(other.errors[i].error_m, one.errors[i].error_m) << i;
        ASSERT_EQ(other.errors[i].error_rad, one.errors[i].error_rad) << i;
      }
      ASSERT_EQ(other.states.size(), one.states.size());
      for (std::size_t i = 0; i < one.states.size(); ++i) {
        ASSERT_EQ(other.states[i].probability, one.states[i].probability) << i;
      }
    }
  }
}

}  // namespace
}  // namespace strata::pipeline
