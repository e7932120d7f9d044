// SPDX-License-Identifier: Apache-2.0
#include "tools/statistics/statistics.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::statistics {
namespace {

TEST(Wilcoxon, EqualsCountingAllSignPatterns) {
  // Ranks 1..8, one negative of rank 3: sums up to 3 arise from {}, 1, 2, 3, 1+2: 5 of 256.
  const std::vector<double> differences{1.0, 2.0, -3.0, 4.0, 5.0, 6.0, 7.0, 8.0};
  EXPECT_NEAR(wilcoxon_signed_rank(differences), 2.0 * 5.0 / 256.0, 1e-12);
}

TEST(Wilcoxon, SharesRanksOfTies) {
  // All four alike: mid-ranks 2.5; one negative: sums 0 and 2.5 arise in 1 + 4 of 16 patterns.
  const std::vector<double> differences{1.0, 1.0, 1.0, -1.0};
  EXPECT_NEAR(wilcoxon_signed_rank(differences), 2.0 * 5.0 / 16.0, 1e-12);
}

TEST(Wilcoxon, OfNoDifferenceIsOne) {
  EXPECT_EQ(wilcoxon_signed_rank(std::vector<double>{0.0, 0.0}), 1.0);
}

TEST(Wilcoxon, ApproximationMeetsTheExactFormAtItsBorder) {
  // 25 differences are counted, 26 approximated; adding one small positive changes little.
  std::vector<double> differences;
  for (int i = 1; i <= 25; ++i) differences.push_back((i % 3 == 0 ? -1.0 : 1.0) * (i + 1.0));
  const double exact = wilcoxon_signed_rank(differences);
  differences.push_back(0.5);
  EXPECT_NEAR(wilcoxon_signed_rank(differences), exact, 0.03);
}

TEST(Holm, FollowsTheStepDownDefinition) {
  const std::vector<double> adjusted = holm(std::vector<double>{0.01, 0.04, 0.03});
  EXPECT_NEAR(adjusted[0], 0.03, 1e-12);
  EXPECT_NEAR(adjusted[2], 0.06, 1e-12);
  EXPECT_NEAR(adjusted[1], 0.06, 1e-12);  // never below a smaller p's adjusted value
}

TEST(McNemar, IsABinomialTail) {
  EXPECT_NEAR(mcnemar_exact(0, 5), 2.0 / 32.0, 1e-12);
  EXPECT_NEAR(mcnemar_exact(1, 5), 2.0 * 7.0 / 64.0, 1e-12);
  EXPECT_EQ(mcnemar_exact(0, 0), 1.0);
  EXPECT_EQ(mcnemar_exact(4, 4), 1.0);
}

TEST(CliffsDelta, IsOneWhenAllAreLarger) {
  EXPECT_EQ(cliffs_delta(std::vector<double>{4, 5}, std::vector<double>{1, 2, 3}), 1.0);
  EXPECT_EQ(cliffs_delta(std::vector<double>{1, 2}, std::vector<double>{1, 2}), 0.0);
}

TEST(Bootstrap, CoversTheTrueMeanAboutAsOftenAsItSays) {
  int covered = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(7, StreamId::kTest, static_cast<std::uint64_t>(trial));
    std::vector<double> values(30);
    for (double& value : values) value = random.normal(2.0, 1.0);
    const Interval interval = bootstrap_mean(values, 0.95, 3, 500);
    covered += interval.low <= 2.0 && 2.0 <= interval.high ? 1 : 0;
  }
  EXPECT_GT(covered, kTrials * 88 / 100);
  EXPECT_LT(covered, kTrials);
}

TEST(Bootstrap, IsTheSameForTheSameSeed) {
  const std::vector<double> values{1.0, 4.0, 2.0, 8.0, 5.0};
  const Interval a = bootstrap_mean(values, 0.95, 11);
  const Interval b = bootstrap_mean(values, 0.95, 11);
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  EXPECT_LT(a.low, mean(values));
  EXPECT_GT(a.high, mean(values));
}

TEST(Bootstrap, OfOneValueHasNoWidth) {
  const Interval interval = bootstrap_mean(std::vector<double>{3.0}, 0.95, 1);
  EXPECT_EQ(interval.low, 3.0);
  EXPECT_EQ(interval.high, 3.0);
}

TEST(Median, TakesTheMiddlePair) { EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 2.5); }

TEST(MovingBlocks, AreWiderThanSingleDrawsWhereNeighboursAreAlike) {
  // 20 stretches of 10 equal values: single draws would take them for 200 independent ones.
  std::vector<double> values;
  for (int stretch = 0; stretch < 20; ++stretch) {
    values.insert(values.end(), 10, stretch % 2 == 0 ? 1.0 : -1.0);
  }
  const std::vector<double> weights(values.size(), 1.0);
  const Interval blocks = moving_block_ratio(values, weights, 10, 0.95, 3);
  const Interval single = moving_block_ratio(values, weights, 1, 0.95, 3);
  EXPECT_GT(blocks.high - blocks.low, 1.5 * (single.high - single.low));
  EXPECT_LT(blocks.low, 0.0);
  EXPECT_GT(blocks.high, 0.0);
}

TEST(MovingBlocks, WeighAMeanByItsWeights) {
  const std::vector<double> values{2.0, 6.0, 4.0};
  const std::vector<double> weights{1.0, 3.0, 2.0};
  const Interval interval = moving_block_ratio(values, weights, 2, 0.95, 1);
  EXPECT_DOUBLE_EQ(interval.low, 2.0);
  EXPECT_DOUBLE_EQ(interval.high, 2.0);
}

}  // namespace
}  // namespace strata::statistics
