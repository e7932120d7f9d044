// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/decode.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::memory {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr float kOpen = std::numeric_limits<float>::infinity();

TEST(Decode, GivesNothingForALevelThatSawNothing) {
  const NodeLevel level({36, 20, 1.5}, 5, false);
  for (const auto& config :
       {scene_decoding(), exact_decoding(), paper_decoding(), literal_decoding()}) {
    const DecodedScan scan = decode(level, config);
    ASSERT_EQ(scan.range_m.size(), 36U);
    EXPECT_TRUE(std::all_of(scan.range_m.begin(), scan.range_m.end(),
                            [](float range) { return std::isnan(range); }));
    EXPECT_FALSE(scan.inconsistent);
  }
}

TEST(Decode, GivesRangesThatWereMeasured) {
  RandomStream random(3, StreamId::kTest);
  NodeLevel level({60, 20, 1.5}, 20, false);
  VirtualScan scan(60);
  for (int t = 0; t < 15; ++t) {
    for (float& range : scan) range = static_cast<float>(random.normal(1.0, 0.1));
    level.insert(scan, random);
  }
  const DecodedScan decoded = decode(level, exact_decoding());
  EXPECT_FALSE(decoded.inconsistent);
  for (int a = 0; a < 60; ++a) {
    const auto samples = level.samples(a);
    EXPECT_NE(
        std::find(samples.begin(), samples.end(), decoded.range_m[static_cast<std::size_t>(a)]),
        samples.end());
  }
}

TEST(Decode, TakesTheLowerMedianOfAnEvenNumberOfSamples) {
  NodeLevel level({3, 1, 4.0}, 10, false);
  RandomStream random(1, StreamId::kTest);
  for (const float range : {3.0F, 1.0F, 2.0F, 2.5F}) {
    level.insert({range, kNothing, kNothing}, random);
  }
  EXPECT_EQ(decode(level, exact_decoding()).range_m[0], 2.0F);
  EXPECT_EQ(decode_per_bin_median(level)[0], 2.0F);
}

TEST(Decode, KeepsUnseenBinsUnknownAndOpenBinsOpen) {
  NodeLevel level({4, 10, 1.0}, 10, false);
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 3; ++i) level.insert({0.5F, kNothing, kOpen, kOpen}, random);
  const DecodedScan scan = decode(level, exact_decoding());
  EXPECT_EQ(scan.range_m[0], 0.5F);
  EXPECT_TRUE(std::isnan(scan.range_m[1]));
  EXPECT_EQ(scan.range_m[2], kOpen);
  EXPECT_EQ(scan.range_m[3], kOpen);
}

TEST(Decode, FallsBackToEachBinsMajorityWhenNoPathCloses) {
  // Bins 0 and 1 were never seen together, so literal weights have no edge between them.
  NodeLevel level({3, 10, 1.0}, 10, false);
  RandomStream random(1, StreamId::kTest);
  for (const float range : {0.55F, 0.55F, 0.25F}) {
    level.insert({range, kNothing, kNothing}, random);
    level.insert({kNothing, range, kNothing}, random);
  }
  for (const auto& config : {paper_decoding(), literal_decoding()}) {
    const DecodedScan scan = decode(level, config);
    EXPECT_TRUE(scan.inconsistent);
    EXPECT_EQ(scan.range_m[0], 0.55F);
    EXPECT_EQ(scan.range_m[1], 0.55F);
    EXPECT_TRUE(std::isnan(scan.range_m[2]));
  }
  // Smoothing joins them.
  EXPECT_FALSE(decode(level, exact_decoding()).inconsistent);
}

TEST(Decode, FindsTheSameCostByBothSearches) {
  RandomStream random(9, StreamId::kTest);
  for (int trial = 0; trial < 20; ++trial) {
    NodeLevel level({90, 20, 1.5}, 20, false);
    VirtualScan scan(90);
    for (int t = 0; t < 25; ++t) {
      const double state = random.bernoulli(0.5) ? 0.6 : 1.1;
      for (float& range : scan) {
        range = random.bernoulli(0.2) ? kNothing : static_cast<float>(random.normal(state, 0.03));
      }
      level.insert(scan, random);
    }
    for (DecodingConfig config :
         {scene_decoding(), exact_decoding(), paper_decoding(), literal_decoding()}) {
      config.search = SearchMethod::kLayered;
      const DecodedScan layered = decode(level, config);
      config.search = SearchMethod::kDijkstra;
      const DecodedScan dijkstra = decode(level, config);
      ASSERT_EQ(layered.inconsistent, dijkstra.inconsistent);
      if (layered.inconsistent) continue;
      EXPECT_NEAR(layered.cost, dijkstra.cost, 1e-9 * dijkstra.cost);
    }
  }
}

}  // namespace
}  // namespace strata::memory
