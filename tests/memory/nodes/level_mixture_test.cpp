// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/level_mixture.hpp"

#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "memory/nodes/timescale_memory.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

/// ln p of a beam under each level; the first, or the last, predicts the scans.
const std::vector<double> kFirst{-1.0, -1.5, -2.0};
const std::vector<double> kLast{-2.0, -1.5, -1.0};

TEST(LevelMixture, BelievesTheSlowestLevelUntilAnotherHasPredictedBetter) {
  LevelMixture mixture({}, 3);
  EXPECT_DOUBLE_EQ(mixture.weights(0)[0], 0.005);
  EXPECT_DOUBLE_EQ(mixture.weights(0)[1], 0.005);
  EXPECT_DOUBLE_EQ(mixture.weights(0)[2], 0.99);
  for (int t = 0; t < 5; ++t) mixture.update(0, kFirst);
  EXPECT_GT(mixture.weights(0)[0], 0.9);
  for (int t = 0; t < 5; ++t) mixture.update(0, kLast);
  EXPECT_GT(mixture.weights(0)[2], 0.95);
  EXPECT_NEAR(std::accumulate(mixture.weights(0).begin(), mixture.weights(0).end(), 0.0), 1.0,
              1e-12);
  // Forgetting leaves every level a chance.
  EXPECT_GE(mixture.weights(0)[0], 0.02 * 0.005);
  // What one node has shown says nothing of another.
  EXPECT_DOUBLE_EQ(mixture.weights(1)[2], 0.99);
}

// A level that predicts neither better nor worse stays where it began.
TEST(LevelMixture, GivesNothingForPredictingAsWellAsTheOthers) {
  LevelMixture mixture({}, 3);
  const std::vector<double> alike(3, -1.2);
  for (int t = 0; t < 100; ++t) mixture.update(0, alike);
  EXPECT_NEAR(mixture.weights(0)[0], 0.005, 1e-12);
  EXPECT_NEAR(mixture.weights(0)[2], 0.99, 1e-12);
}

TEST(LevelMixture, StartsEvenWhereNothingHasToBeEarned) {
  LevelMixtureConfig config;
  config.unearned = 1.0;
  LevelMixture mixture(config, 4);
  for (const double weight : mixture.weights(0)) EXPECT_DOUBLE_EQ(weight, 0.25);
}

// Bayes' rule in closed form: without forgetting the odds of two levels are e^(beta t (a - b)).
TEST(LevelMixture, WeighsEachLevelByTheLikelihoodOfTheScans) {
  LevelMixtureConfig config;
  config.forgetting = 0.0;
  config.effective_beams = 3.0;
  config.unearned = 0.2;
  LevelMixture mixture(config, 3);
  for (int t = 1; t <= 4; ++t) {
    mixture.update(0, kFirst);
    const auto weights = mixture.weights(0);
    EXPECT_NEAR(std::log(weights[0] / weights[1]), 3.0 * t * 0.5, 1e-9);
    EXPECT_NEAR(std::log(weights[0] / weights[2]), 3.0 * t * 1.0 + std::log(0.2 / 0.6), 1e-9);
  }
}

TEST(LevelMixture, LearnsNothingWhereThereIsNoNode) {
  TimescaleMemory memory({}, 1);
  for (int t = 0; t < 40; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, false));
  const auto map = memory.decode();
  EXPECT_EQ(LevelMixture::node_at(*map, {0.1, 0.1}), 0);
  EXPECT_EQ(LevelMixture::node_at(*map, {50.0, 0.0}), -1);
  LevelMixture mixture({}, 3);
  mixture.update(-1, kFirst);
  EXPECT_DOUBLE_EQ(mixture.weights(-1)[2], 0.99);
}

TEST(LevelMixture, RefusesWeightsThatAreNone) {
  LevelMixtureConfig config;
  config.unearned = 1.5;
  EXPECT_THROW(LevelMixture(config, 3), ConfigError);
}

}  // namespace
}  // namespace strata::memory
