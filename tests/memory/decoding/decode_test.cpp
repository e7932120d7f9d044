// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/decode.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "memory/decoding/row_counts.hpp"

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

/// One bin with these samples, and two that were never seen.
NodeLevel level_of(const std::vector<float>& samples) {
  NodeLevel level({3, 50, 8.0}, 60, false);
  RandomStream random(1, StreamId::kTest);
  for (const float range_m : samples) level.insert({range_m, kNothing, kNothing}, random);
  return level;
}

/// The estimate in another way: each sample without a range hands all that it counts, in equal
/// parts, to those that lie further, the nearest first.
std::vector<double> redistributed(const NodeLevel& level) {
  std::vector<float> samples(level.samples(0).begin(), level.samples(0).end());
  const PolarBins& bins = level.bins();
  // A range in the bin of f may lie beyond f.
  const auto place = [&](float range_m) {
    return 2 * bins.range_bin(std::abs(range_m)) + (range_m < 0.0F ? 0 : 1);
  };
  std::sort(samples.begin(), samples.end(), [&](float a, float b) { return place(a) < place(b); });
  std::vector<double> counts(samples.size(), 1.0);
  std::vector<double> result(256, 0.0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i] >= 0.0F) {
      result[bins.range_bin(samples[i])] += counts[i];
      continue;
    }
    std::size_t first = i + 1;
    while (first < samples.size() && place(samples[first]) == place(samples[i])) ++first;
    const auto further = static_cast<double>(samples.size() - first);
    if (first == samples.size()) result[static_cast<std::size_t>(bins.beyond_bin())] += counts[i];
    for (std::size_t k = first; k < samples.size(); ++k) counts[k] += counts[i] / further;
  }
  return result;
}

TEST(RowCounts, CountWhatHasNoRangeForAllThatLiesFurther) {
  detail::RowCounts row;
  const auto counts = [&](const std::vector<float>& samples) {
    row.fill(level_of(samples), 0);
    std::vector<double> result;
    for (const std::uint8_t state : row.states) result.push_back(row.count[state]);
    return result;
  };
  // All that hides the range from 2 m on lies behind the two at 1 m: 6 of 8 at 3 m.
  EXPECT_EQ(counts({1.0F, 1.0F, -2.0F, -2.0F, -2.0F, -2.0F, 3.0F, 3.0F}),
            (std::vector<double>{2.0, 6.0}));
  // Of those 6 the three that were seen to 3.9 m are as likely as the one at 3 m.
  EXPECT_EQ(counts({1.0F, 1.0F, -2.0F, -2.0F, 3.0F, -3.9F, -3.9F, -3.9F}),
            (std::vector<double>{2.0, 1.5, 4.5}));
  EXPECT_EQ(row.states.back(), 52);
  // What is said of nearer places says nothing of a surface behind.
  EXPECT_EQ(counts({-2.0F, 3.0F}), (std::vector<double>{2.0}));
  EXPECT_EQ(counts({-2.0F}), (std::vector<double>{1.0}));
}

TEST(RowCounts, AreTheSameHandedOnOneByOne) {
  RandomStream random(5, StreamId::kTest);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<float> samples;
    for (int i = 0; i < 40; ++i) {
      const auto range_m = static_cast<float>(random.uniform(0.1, 7.9));
      samples.push_back(random.bernoulli(0.4) ? -range_m : range_m);
    }
    const NodeLevel level = level_of(samples);
    detail::RowCounts row;
    row.fill(level, 0);
    const std::vector<double> expected = redistributed(level);
    double total = 0.0;
    double spread = 0.0;
    for (std::size_t i = 0; i < row.states.size(); ++i) {
      ASSERT_NEAR(row.count[row.states[i]], expected[row.states[i]], 1e-9);
      total += row.count[row.states[i]];
      spread += row.spread[i];
    }
    EXPECT_NEAR(total, 40.0, 1e-9);
    EXPECT_NEAR(spread, 1.0, 1e-9);
  }
}

// An object stood here in a sixth of the scans, and is gone; what stands behind is out of reach.
TEST(Decode, ForgetsWhatVanishesWhereTheScannerDoesNotReachWhatIsBehind) {
  for (const bool is_said : {false, true}) {
    NodeLevel level({60, 50, 8.0}, 60, false);
    RandomStream random(1, StreamId::kTest);
    for (int t = 0; t < 60; ++t) {
      VirtualScan scan(60, 1.5F);
      const float free_m = -3.5F - 0.01F * static_cast<float>(t % 20);
      for (std::size_t a = 20; a < 30; ++a) scan[a] = t < 10 ? 2.1F : is_said ? free_m : kNothing;
      level.insert(scan, random);
    }
    for (const auto& config : {scene_decoding(), exact_decoding(), paper_decoding()}) {
      const DecodedScan decoded = decode(level, config);
      for (std::size_t a = 0; a < 60; ++a) {
        const bool is_inside = a >= 20 && a < 30;
        EXPECT_FLOAT_EQ(decoded.range_m[a], !is_inside ? 1.5F : is_said ? -3.61F : 2.1F) << a;
      }
    }
  }
}

// ... and stays while most scans still show it.
TEST(Decode, KeepsWhatStandsMostOfTheTime) {
  NodeLevel level({60, 50, 8.0}, 60, false);
  RandomStream random(1, StreamId::kTest);
  for (int t = 0; t < 60; ++t) {
    VirtualScan scan(60, 1.5F);
    for (std::size_t a = 20; a < 30; ++a) scan[a] = t % 6 != 0 ? 2.1F : -3.5F;
    level.insert(scan, random);
  }
  for (const auto& config : {scene_decoding(), exact_decoding(), paper_decoding()}) {
    EXPECT_EQ(decode(level, config).range_m[25], 2.1F);
  }
}

}  // namespace
}  // namespace strata::memory
