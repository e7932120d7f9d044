// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "memory/nodes/level_mixture.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

TimescaleMemory memory_with_new_box() {
  TimescaleMemory memory({}, 1);
  for (int t = 0; t < 400; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, t >= 390));
  return memory;
}

TEST(LevelMixture, BelievesTheLevelThatPredictsTheScans) {
  const auto map = memory_with_new_box().decode();
  const Pose2 pose{0.1, 0.1, 0.3};
  LevelMixture mixture({}, 3);
  EXPECT_NEAR(mixture.weights(0)[0], 1.0 / 3.0, 1e-12);
  for (int t = 0; t < 5; ++t) {
    EXPECT_EQ(mixture.update(*map, pose, observe(pose, 500.0 + t, true).scan), 0);
  }
  EXPECT_GT(mixture.weights(0)[0], 0.9);
  for (int t = 0; t < 5; ++t) mixture.update(*map, pose, observe(pose, 600.0 + t, false).scan);
  EXPECT_LT(mixture.weights(0)[0], 0.05);
  EXPECT_NEAR(std::accumulate(mixture.weights(0).begin(), mixture.weights(0).end(), 0.0), 1.0,
              1e-12);
  // Forgetting leaves every level a chance.
  EXPECT_GE(mixture.weights(0)[0], 0.02 / 3.0);
}

TEST(LevelMixture, ExpectsTheRangesOfTheLevelItBelieves) {
  const auto map = memory_with_new_box().decode();
  const Pose2 pose{0.0, 0.0, 0.0};
  LevelMixture mixture({}, 3);
  const std::vector<double> bearings{0.0};
  std::vector<float> ranges(1);
  std::vector<float> scratch;
  for (const bool with_box : {true, false}) {
    for (int t = 0; t < 5; ++t) {
      mixture.update(*map, pose, observe(pose, 500.0 + t, with_box).scan);
    }
    mixture.expected_ranges_m(*map, pose, bearings, ranges, scratch);
    EXPECT_NEAR(ranges[0], with_box ? 2.0F : 5.0F, 0.1F);
  }
}

TEST(LevelMixture, LearnsNothingWhereThereIsNoNode) {
  const auto map = memory_with_new_box().decode();
  LevelMixture mixture({}, 3);
  EXPECT_EQ(mixture.update(*map, {50.0, 0.0, 0.0}, observe({0, 0, 0}, 0.0, false).scan), -1);
  std::vector<float> ranges(1, 1.0F);
  std::vector<float> scratch;
  const std::vector<double> bearings{0.0};
  mixture.expected_ranges_m(*map, {50.0, 0.0, 0.0}, bearings, ranges, scratch);
  EXPECT_TRUE(std::isnan(ranges[0]));
}

}  // namespace
}  // namespace strata::memory
