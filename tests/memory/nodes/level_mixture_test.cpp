// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/level_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

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

// Bayes' rule, worked out here from what each level expects.
TEST(LevelMixture, WeighsEachLevelByTheLikelihoodOfTheScan) {
  const auto map = memory_with_new_box().decode();
  const Pose2 pose{0.1, 0.1, 0.3};
  LevelMixtureConfig config;
  config.forgetting = 0.0;
  config.effective_beams = 1.0;  // or the weights would be 0 and 1 at once
  LevelMixture mixture(config, 3);
  std::vector<double> product(3, 1.0 / 3.0);
  for (const bool with_box : {true, true, false}) {
    Scan scan = observe(pose, 500.0, with_box).scan;
    ASSERT_EQ(scan.size() % 60, 0U);  // it looks at 60 beams
    const std::size_t step = scan.size() / 60;
    double total = 0.0;
    for (int level = 0; level < 3; ++level) {
      double sum = 0.0;
      for (std::size_t beam = 0; beam < scan.size(); beam += step) {
        const double expected_m =
            static_cast<double>(map->expected_range_m(level, pose, scan.bearing_rad(beam)));
        const double measured_m = static_cast<double>(scan.ranges_m[beam]);
        const double z = (measured_m - expected_m) / config.sigma_m;
        const double hit = config.hit / (config.sigma_m * std::sqrt(2.0 * std::numbers::pi));
        const double odd = (1.0 - config.hit) / map->bins().max_range_m;
        ASSERT_TRUE(std::isfinite(expected_m));
        sum += std::log(hit * std::exp(-0.5 * z * z) + odd) / 60.0;
      }
      product[static_cast<std::size_t>(level)] *= std::exp(sum);
      total += product[static_cast<std::size_t>(level)];
    }
    mixture.update(*map, pose, scan);
    for (std::size_t level = 0; level < 3; ++level) {
      EXPECT_NEAR(mixture.weights(0)[level], product[level] / total, 1e-5) << level;
    }
  }
}

/// What the most trusted level that knows it expects straight ahead.
float believed_range_m(const LevelMixture& mixture, const NodeMap& map, const Pose2& pose) {
  const auto weights = mixture.weights(LevelMixture::node_at(map, pose.translation()));
  std::vector<std::size_t> order(weights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });
  for (const std::size_t level : order) {
    const float range_m = map.expected_range_m(static_cast<int>(level), pose, 0.0);
    if (!std::isnan(range_m)) return range_m;
  }
  return std::numeric_limits<float>::quiet_NaN();
}

// Every 2nd of 119 beams is looked at, not each: what only the others see changes nothing.
TEST(LevelMixture, LooksAtNoMoreThanSixtyBeams) {
  const auto map = memory_with_new_box().decode();
  const Pose2 pose{0.1, 0.1, 0.3};
  Scan scan = observe(pose, 500.0, true).scan;
  scan.ranges_m.resize(119);
  Scan other = scan;
  for (std::size_t beam = 1; beam < other.size(); beam += 2) other.ranges_m[beam] = 0.3F;
  LevelMixture of_scan({}, 3);
  LevelMixture of_other({}, 3);
  of_scan.update(*map, pose, scan);
  of_other.update(*map, pose, other);
  for (std::size_t level = 0; level < 3; ++level) {
    EXPECT_EQ(of_other.weights(0)[level], of_scan.weights(0)[level]);
  }
}

TEST(LevelMixture, ExpectsTheRangesOfTheLevelItBelieves) {
  const auto map = memory_with_new_box().decode();
  const Pose2 pose{0.0, 0.0, 0.0};
  LevelMixture mixture({}, 3);
  for (const bool with_box : {true, false}) {
    for (int t = 0; t < 5; ++t) {
      mixture.update(*map, pose, observe(pose, 500.0 + t, with_box).scan);
    }
    EXPECT_NEAR(believed_range_m(mixture, *map, pose), with_box ? 2.0F : 5.0F, 0.1F);
  }
}

TEST(LevelMixture, LearnsNothingWhereThereIsNoNode) {
  const auto map = memory_with_new_box().decode();
  LevelMixture mixture({}, 3);
  EXPECT_EQ(mixture.update(*map, {50.0, 0.0, 0.0}, observe({0, 0, 0}, 0.0, false).scan), -1);
  EXPECT_TRUE(std::isnan(believed_range_m(mixture, *map, {50.0, 0.0, 0.0})));
}

}  // namespace
}  // namespace strata::memory
