// SPDX-License-Identifier: Apache-2.0
#include "core/random/stream.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace strata {
namespace {

using Block = std::array<std::uint32_t, 4>;
using Key = std::array<std::uint32_t, 2>;

TEST(Philox, EqualsThePublishedVectors) {
  // philox4x32-10 of the known-answer tests that come with [salmon2011parallel].
  EXPECT_EQ(philox4x32_10(Block{}, Key{}),
            (Block{0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}));
  const std::uint32_t ones = 0xffffffffU;
  EXPECT_EQ(philox4x32_10({ones, ones, ones, ones}, {ones, ones}),
            (Block{0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU}));
  EXPECT_EQ(philox4x32_10({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U},
                          {0xa4093822U, 0x299f31d0U}),
            (Block{0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U}));
}

TEST(RandomStream, RepeatsWithItsKeyAndDiffersWithAnyPartOfIt) {
  auto first = [](std::uint64_t seed, StreamId id, std::uint64_t step, std::uint32_t index) {
    return RandomStream(seed, id, step, index).next_u64();
  };
  EXPECT_EQ(first(1, StreamId::kMotion, 2, 3), first(1, StreamId::kMotion, 2, 3));
  std::set<std::uint64_t> values;
  for (std::uint64_t seed : {0ULL, 1ULL, 1ULL << 40U}) {
    for (StreamId id : {StreamId::kTest, StreamId::kMotion, StreamId::kTopology}) {
      for (std::uint64_t step : {0ULL, 1ULL, 1ULL << 33U}) {
        for (std::uint32_t index : {0U, 1U, 0xffffffffU})
          values.insert(first(seed, id, step, index));
      }
    }
  }
  EXPECT_EQ(values.size(), 81U);
}

TEST(RandomStream, UniformFillsTheUnitIntervalEvenly) {
  RandomStream random(7, StreamId::kTest);
  std::array<int, 20> bins{};
  constexpr int kDraws = 200'000;
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    ++bins[static_cast<std::size_t>(u * 20.0)];
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / kDraws));
  double chi_squared = 0.0;
  for (const int n : bins) chi_squared += std::pow(n - kDraws / 20.0, 2.0) / (kDraws / 20.0);
  EXPECT_LT(chi_squared, 50.8);  // 19 degrees of freedom, p = 1e-4
}

TEST(RandomStream, NormalHasTheMomentsOfANormal) {
  RandomStream random(8, StreamId::kTest);
  constexpr int kDraws = 400'000;
  std::array<double, 5> moment{};
  double product = 0.0;
  double previous = random.normal();
  for (int i = 0; i < kDraws; ++i) {
    const double z = random.normal();
    for (std::size_t k = 1; k < moment.size(); ++k) {
      moment[k] += std::pow(z, static_cast<double>(k)) / kDraws;
    }
    product += z * previous / kDraws;
    previous = z;
  }
  const double sigma = 1.0 / std::sqrt(static_cast<double>(kDraws));
  EXPECT_NEAR(moment[1], 0.0, 5.0 * sigma);
  EXPECT_NEAR(moment[2], 1.0, 5.0 * sigma * std::sqrt(2.0));
  EXPECT_NEAR(moment[3], 0.0, 5.0 * sigma * std::sqrt(15.0));
  EXPECT_NEAR(moment[4], 3.0, 5.0 * sigma * std::sqrt(96.0));
  EXPECT_NEAR(product, 0.0, 5.0 * sigma);  // the pair of one Box-Muller draw is independent
}

TEST(RandomStream, BelowReachesEveryValueEquallyOften) {
  RandomStream random(9, StreamId::kTest);
  std::array<int, 7> bins{};
  constexpr int kDraws = 70'000;
  for (int i = 0; i < kDraws; ++i) ++bins.at(random.below(7));
  for (const int n : bins) EXPECT_NEAR(n, kDraws / 7.0, 5.0 * std::sqrt(kDraws / 7.0));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(random.below(1), 0U);
  // A bound where plain modulo would favour the lower half by two to one.
  int low = 0;
  for (int i = 0; i < kDraws; ++i) low += random.below(3'000'000'000U) < 1'500'000'000U ? 1 : 0;
  EXPECT_NEAR(low, kDraws / 2.0, 5.0 * std::sqrt(kDraws / 4.0));
}

TEST(RandomStream, ExponentialHasItsRate) {
  RandomStream random(10, StreamId::kTest);
  constexpr int kDraws = 200'000;
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.exponential(4.0);
    ASSERT_GE(x, 0.0);
    sum += x;
  }
  EXPECT_NEAR(sum / kDraws, 0.25, 5.0 * 0.25 / std::sqrt(static_cast<double>(kDraws)));
}

TEST(RandomStream, CategoricalFollowsItsWeightsAndNeverPicksAZero) {
  RandomStream random(11, StreamId::kTest);
  const std::vector<double> weights{0.0, 1.0, 0.0, 3.0, 4.0};
  std::vector<int> bins(weights.size());
  constexpr int kDraws = 80'000;
  for (int i = 0; i < kDraws; ++i) ++bins[random.categorical(weights)];
  EXPECT_EQ(bins[0], 0);
  EXPECT_EQ(bins[2], 0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double p = weights[i] / 8.0;
    EXPECT_NEAR(bins[i], kDraws * p, 5.0 * std::sqrt(kDraws * p * (1.0 - p)));
  }
}

TEST(RandomStream, CategoricalNeverPicksATrailingZero) {
  // Subtracting the weights one by one rounds; the rest must not fall to a weight of zero.
  const std::vector<double> weights{0.1, 0.2, 0.3, 0.4, 0.0};
  RandomStream random(12, StreamId::kTest);
  for (int i = 0; i < 100'000; ++i) ASSERT_LT(random.categorical(weights), 4U);
}

TEST(RandomStream, BernoulliIsCertainAtItsEnds) {
  RandomStream random(13, StreamId::kTest);
  for (int i = 0; i < 1'000; ++i) {
    EXPECT_FALSE(random.bernoulli(0.0));
    EXPECT_TRUE(random.bernoulli(1.0));
  }
}

}  // namespace
}  // namespace strata
