// SPDX-License-Identifier: Apache-2.0
#include "memory/levels/node_level.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/config.hpp"
#include "memory/levels/level_config.hpp"

namespace strata::memory {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr float kOpen = std::numeric_limits<float>::infinity();

TEST(PolarBins, PutEveryRangeInOneBinAndTheRestInTheOverflowBin) {
  const PolarBins bins{360, 20, 1.5};
  EXPECT_EQ(bins.range_bin(0.0F), 0);
  EXPECT_EQ(bins.range_bin(0.0749F), 0);
  EXPECT_EQ(bins.range_bin(0.0751F), 1);
  EXPECT_EQ(bins.range_bin(std::nextafter(1.5F, 0.0F)), 19);
  EXPECT_EQ(bins.range_bin(1.5F), 20);
  EXPECT_EQ(bins.range_bin(kOpen), 20);
}

// Defect 4: u = 1 - e^-lambda, not e^lambda - 1.
TEST(LevelConfig, RelatesHalfLifeAndReplacementRate) {
  for (const double half_life : {3.1, 27.0, 693.0}) {
    const LevelConfig level{"x", 20, half_life};
    const double u = level.replacement_rate(1.0);
    const double lambda = -std::log(1.0 - u);
    EXPECT_NEAR(std::numbers::ln2 / lambda, half_life, 1e-9 * half_life);
    EXPECT_NEAR(u, 1.0 - std::exp(-lambda), 1e-15);
    EXPECT_NEAR(half_life_observations(20, level.insertion_probability(1.0)), half_life,
                1e-9 * half_life);
  }
}

TEST(LevelConfig, GivesTheUsualThreeLevels) {
  EXPECT_NEAR(half_life_observations(5, 1.0), 3.1, 0.01);
  EXPECT_NEAR(half_life_observations(20, 0.5), 27.4, 0.05);
  EXPECT_NEAR(half_life_observations(50, 0.05), 693.0, 0.5);
}

TEST(LevelConfig, MustHaveAName) {
  EXPECT_EQ(validate(LevelConfig{"", 5, 3.0}).size(), 1U);
  EXPECT_EQ(validate(LevelConfig{"short", 5, -1.0}).size(), 1U);
  EXPECT_TRUE(validate(LevelConfig{"short", 5, 3.1}).empty());
}

TEST(NodeLevel, KeepsWhatItSawUntilItIsFull) {
  NodeLevel level({4, 10, 1.0}, 2, false);
  RandomStream random(1, StreamId::kTest);
  level.insert({0.05F, kNothing, kOpen, 0.95F}, random);
  EXPECT_THAT(level.samples(0), testing::ElementsAre(0.05F));
  EXPECT_TRUE(level.samples(1).empty());
  EXPECT_THAT(level.samples(2), testing::ElementsAre(kOpen));
  // Pairs join neighbours around the circle, only where both are known.
  EXPECT_TRUE(level.pairs(0).empty());
  EXPECT_TRUE(level.pairs(1).empty());
  EXPECT_THAT(level.pairs(2), testing::ElementsAre(RangePair{10, 9}));
  EXPECT_THAT(level.pairs(3), testing::ElementsAre(RangePair{9, 0}));
  EXPECT_EQ(level.insertions(), 1U);
}

TEST(NodeLevel, NeverHoldsMoreThanItsCapacity) {
  NodeLevel level({8, 10, 1.0}, 5, true);
  RandomStream random(2, StreamId::kTest);
  VirtualScan scan(8);
  for (int t = 0; t < 100; ++t) {
    for (float& range : scan) {
      range = random.bernoulli(0.3) ? kNothing : static_cast<float>(random.uniform(0.0, 1.2));
    }
    level.insert(scan, random);
    for (int a = 0; a < 8; ++a) {
      EXPECT_LE(level.samples(a).size(), 5U);
      EXPECT_LE(level.pairs(a).size(), 5U);
    }
  }
}

/// Observations after which half of the samples of a full set are gone; between two observations
/// survivors are taken to fall exponentially.
double measured_half_life(int capacity, double insertion_probability, int trials,
                          std::uint64_t seed) {
  std::vector<int> lives;
  for (int trial = 0; trial < trials; ++trial) {
    RandomStream random(seed, StreamId::kTest, static_cast<std::uint64_t>(trial));
    NodeLevel level({3, 4, 4.0}, capacity, false);
    for (int i = 0; i < capacity; ++i) {
      level.insert({i == 0 ? 1.5F : 2.5F, kNothing, kNothing}, random);
    }
    int life = 0;
    auto alive = [&] {
      return std::count(level.samples(0).begin(), level.samples(0).end(), 1.5F) > 0;
    };
    while (alive()) {
      ++life;
      if (random.bernoulli(insertion_probability)) {
        level.insert({2.5F, kNothing, kNothing}, random);
      }
    }
    lives.push_back(life);
  }
  const auto alive_after = [&](int observations) {
    return static_cast<double>(std::count_if(lives.begin(), lives.end(),
                                             [&](int life) { return life > observations; })) /
           trials;
  };
  int t = 0;
  while (alive_after(t + 1) > 0.5) ++t;
  const double before = alive_after(t);
  return t + std::log(before / 0.5) / std::log(before / alive_after(t + 1));
}

TEST(NodeLevel, ForgetsHalfOfItsSamplesInOneHalfLife) {
  for (const auto& [capacity, q] : {std::pair{5, 1.0}, {20, 0.5}, {50, 0.05}}) {
    const double theory = half_life_observations(capacity, q);
    const auto seed = static_cast<std::uint64_t>(capacity);
    EXPECT_NEAR(measured_half_life(capacity, q, 4000, seed), theory, 0.1 * theory) << capacity;
  }
}

TEST(NodeLevel, HalvesTheShareOfAnOldStateInOneHalfLife) {
  // The mean share over many bins decays as 2^(-t / half-life).
  constexpr int kRing = 360;
  for (const auto& [capacity, q] : {std::pair{5, 1.0}, {20, 0.5}, {50, 0.05}}) {
    NodeLevel level({kRing, 4, 4.0}, capacity, false);
    RandomStream random(7, StreamId::kTest, static_cast<std::uint64_t>(capacity));
    for (int i = 0; i < capacity; ++i) level.insert(VirtualScan(kRing, 1.5F), random);
    const double half_life = half_life_observations(capacity, q);
    // Each insertion replaces 1 of N; t observations make about q t of them.
    const double insertions = q * std::round(half_life);
    for (int i = 0; i < static_cast<int>(std::round(insertions)); ++i) {
      level.insert(VirtualScan(kRing, 2.5F), random);
    }
    double old = 0.0;
    for (int a = 0; a < kRing; ++a) {
      old +=
          static_cast<double>(std::count(level.samples(a).begin(), level.samples(a).end(), 1.5F));
    }
    const double expected = std::pow(1.0 - 1.0 / capacity, std::round(insertions));
    EXPECT_NEAR(old / (kRing * capacity), expected, 0.05) << capacity;
    EXPECT_NEAR(old / (kRing * capacity), 0.5, 0.05) << capacity;
  }
}

TEST(NodeLevel, LosesItsPairsAtTheEdgeOfViewOnlyWithCoupledEviction) {
  for (const bool coupled : {true, false}) {
    NodeLevel level({4, 10, 1.0}, 10, coupled);
    RandomStream random(5, StreamId::kTest);
    for (int i = 0; i < 10; ++i) level.insert({0.5F, 0.5F, 0.5F, 0.5F}, random);
    for (int i = 0; i < 200; ++i) level.insert({0.5F, 0.5F, kNothing, kNothing}, random);
    EXPECT_EQ(level.pairs(1).size(), coupled ? 0U : 10U);
    EXPECT_EQ(level.pairs(0).size(), 10U);
  }
}

TEST(NodeLevel, IsTheSameAfterWritingAndReading) {
  const PolarBins bins{90, 30, 3.0};
  NodeLevel level(bins, 7, false);
  RandomStream random(11, StreamId::kTest);
  VirtualScan scan(90);
  for (int t = 0; t < 30; ++t) {
    for (float& range : scan) range = static_cast<float>(random.uniform(0.0, 4.0));
    level.insert(scan, random);
  }
  StateWriter first;
  first(level);
  const std::vector<std::uint8_t> bytes = first.take();
  NodeLevel copy(bins, 7, false);
  StateReader in(bytes, "test");
  in(copy);
  in.expect_end();
  StateWriter second;
  second(copy);
  EXPECT_EQ(second.take(), bytes);
}

TEST(NodeLevel, RefusesBytesThatCannotBeItsOwn) {
  const PolarBins bins{4, 10, 1.0};
  NodeLevel level(bins, 3, false);
  RandomStream random(1, StreamId::kTest);
  level.insert({0.1F, 0.2F, 0.3F, 0.4F}, random);
  StateWriter out;
  out(level);
  const std::vector<std::uint8_t> bytes = out.take();
  const auto read = [&](std::span<const std::uint8_t> changed) {
    NodeLevel other(bins, 3, false);
    StateReader in(changed, "test");
    in(other);
  };
  EXPECT_NO_THROW(read(bytes));
  EXPECT_THROW(read(std::span(bytes).first(bytes.size() - 1)), DamageError);
  std::vector<std::uint8_t> overfull = bytes;
  overfull[8] = 200;
  EXPECT_THROW(read(overfull), DamageError);
}

TEST(NodeLevel, KeepsWhatIsNoNearerThanSomethingAsAKindOfItsOwn) {
  const PolarBins bins{4, 10, 1.0};
  NodeLevel level(bins, 2, false);
  RandomStream random(1, StreamId::kTest);
  level.insert({0.05F, -0.6F, -0.7F, kNothing}, random);
  EXPECT_THAT(level.samples(1), testing::ElementsAre(-0.6F));
  const auto beyond = static_cast<std::uint8_t>(bins.beyond_bin());
  EXPECT_THAT(level.pairs(0), testing::ElementsAre(RangePair{0, beyond}));
  EXPECT_THAT(level.pairs(1), testing::ElementsAre(RangePair{beyond, beyond}));
  StateWriter out;
  out(level);
  const std::vector<std::uint8_t> bytes = out.take();
  NodeLevel again(bins, 2, false);
  StateReader in(bytes, "test");
  in(again);
  EXPECT_THAT(again.samples(2), testing::ElementsAre(-0.7F));
}

TEST(NodeLevel, RefusesFreeWaysLongerThanItsRanges) {
  const PolarBins bins{4, 10, 1.0};
  for (const float range_m : {-1.0F, -kOpen, -0.99F}) {
    NodeLevel level(bins, 2, false);
    RandomStream random(1, StreamId::kTest);
    level.insert({0.05F, range_m, 0.5F, kNothing}, random);
    StateWriter out;
    out(level);
    const std::vector<std::uint8_t> bytes = out.take();
    NodeLevel again(bins, 2, false);
    StateReader in(bytes, "test");
    if (range_m == -0.99F) {
      EXPECT_NO_THROW(in(again));
    } else {
      EXPECT_THROW(in(again), InputError) << range_m;
    }
  }
}

}  // namespace
}  // namespace strata::memory
