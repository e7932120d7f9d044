// SPDX-License-Identifier: Apache-2.0
#include "core/localization/level_choice.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <gtest/gtest.h>

namespace strata::localization {
namespace {

constexpr double kStep_s = 0.1;
constexpr double kMemory_s = 1.0;
const LevelChoiceConfig kConfig;
const double kMuch = 2.0 * kConfig.refuted_nats;

TEST(LevelChoice, BelievesALevelOnceAllOthersAreRefuted) {
  LevelChoice choice(kConfig);
  choice.begin(3, std::nullopt);
  EXPECT_FALSE(choice.is_decided());
  for (int n = 0; n < 50; ++n) choice.weigh(std::array{-kMuch, 0.0, -0.2}, kStep_s, kMemory_s);
  EXPECT_EQ(choice.leading(), 1U);
  EXPECT_FALSE(choice.is_decided()) << "the third is as good";
  for (int n = 0; n < 50; ++n) choice.weigh(std::array{-kMuch, 0.0, -kMuch}, kStep_s, kMemory_s);
  EXPECT_TRUE(choice.is_decided());
  const auto shares = choice.probabilities();
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-12);
  EXPECT_GT(shares[1], 0.95);
}

TEST(LevelChoice, MakesNoProofOfSmallDifferences) {
  LevelChoice choice(kConfig);
  choice.begin(2, std::nullopt);
  for (int n = 0; n < 100'000; ++n) {
    choice.weigh(std::array{-1.0, -1.0 - 0.8 * kConfig.refuted_nats}, kStep_s, kMemory_s);
    ASSERT_FALSE(choice.is_decided());
  }
}

TEST(LevelChoice, LeavesTheLevelThatItHasForNoSingleScan) {
  LevelChoice choice(kConfig);
  choice.begin(2, 0);
  EXPECT_TRUE(choice.is_decided());
  choice.weigh(std::array{-1e9, -1.0}, kStep_s, kMemory_s);
  EXPECT_EQ(choice.leading(), 0U);
  const double inf = std::numeric_limits<double>::infinity();
  choice.weigh(std::array{-inf, -inf}, kStep_s, kMemory_s);
  EXPECT_EQ(choice.leading(), 0U);
}

TEST(LevelChoice, ForgetsWhatWasKnownWhereNothingTellsAnyMore) {
  LevelChoice choice(kConfig);
  choice.begin(2, 1);
  for (int n = 0; n < 15; ++n) choice.weigh(std::array{-3.0, -3.0}, kStep_s, kMemory_s);
  EXPECT_FALSE(choice.is_decided());
  EXPECT_EQ(choice.leading(), 1U);
}

TEST(LevelChoice, CountsTimeAndNotScans) {
  for (const int scans_a_second : {2, 10, 40}) {
    LevelChoice choice(kConfig);
    choice.begin(2, 0);
    double s = 0.0;
    while (choice.leading() == 0 && s < 10.0) {
      choice.weigh(std::array{-kMuch, 0.0}, 1.0 / scans_a_second, kMemory_s);
      s += 1.0 / scans_a_second;
    }
    EXPECT_NEAR(s, std::log(4.0), 0.51);
  }
}

}  // namespace
}  // namespace strata::localization
