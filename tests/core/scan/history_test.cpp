// SPDX-License-Identifier: Apache-2.0
#include "core/scan/history.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace strata {
namespace {

/// A robot that drives 10 m along a corridor each night, there and back, a scan every half metre.
std::vector<PosedScan> nights(int count, int first = 0) {
  std::vector<PosedScan> scans;
  for (int night = first; night < first + count; ++night) {
    for (int i = 0; i < 40; ++i) {
      PosedScan& scan = scans.emplace_back();
      scan.run = night;
      scan.scan.stamp = Stamp::from_seconds(86'400.0 * night + 240.0 + i);
      const double there_m = i < 20 ? 0.25 + 0.5 * i : 9.75 - 0.5 * (i - 20);
      scan.map_from_robot = {there_m, 0.5, i < 20 ? 0.0 : 3.1415};
    }
  }
  return scans;
}

std::vector<PosedScan> kept(const std::vector<PosedScan>& scans, int new_run,
                            const HistoryConfig& config) {
  const std::vector<bool> keeps = scans_to_keep(scans, new_run, config);
  std::vector<PosedScan> left;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (keeps[i]) left.push_back(scans[i]);
  }
  return left;
}

std::vector<std::pair<int, std::int64_t>> names(const std::vector<PosedScan>& scans) {
  std::vector<std::pair<int, std::int64_t>> all;
  for (const PosedScan& scan : scans) all.emplace_back(scan.run, scan.scan.stamp.ns);
  return all;
}

TEST(History, KeepsAllWhereThereAreFewPassesOrNoLimit) {
  const auto scans = nights(12);
  EXPECT_EQ(kept(scans, 12, {.passes_per_place = 12}).size(), scans.size());
  EXPECT_EQ(kept(scans, 12, {.passes_per_place = 0}).size(), scans.size());
  EXPECT_LT(kept(scans, 12, {.passes_per_place = 11}).size(), scans.size());
}

TEST(History, KeepsSoManyPassesOfEachPlaceAndHeading) {
  for (const int limit : {1, 7, 30}) {
    std::map<std::pair<int, bool>, std::set<int>> passes;
    for (const PosedScan& scan : kept(nights(100), 100, {.passes_per_place = limit})) {
      const int place = static_cast<int>(std::floor(scan.map_from_robot.x / 2.0));
      passes[{place, scan.map_from_robot.theta > 1.0}].insert(scan.run);
    }
    ASSERT_EQ(passes.size(), 10U);
    for (const auto& [place, runs] : passes)
      EXPECT_EQ(runs.size(), static_cast<std::size_t>(limit));
  }
}

TEST(History, OfNeighbouringPlacesIsTheSamePasses) {
  std::map<int, std::size_t> scans_of;
  for (const PosedScan& scan : kept(nights(100), 100, {.passes_per_place = 10})) {
    ++scans_of[scan.run];
  }
  EXPECT_EQ(scans_of.size(), 10U);
  for (const auto& [run, scans] : scans_of) EXPECT_EQ(scans, 40U) << "whole drives are kept";
}

TEST(History, ForgottenNightByNightIsForgottenAtOnce) {
  const HistoryConfig config{.passes_per_place = 8};
  std::vector<PosedScan> left;
  for (int night = 0; night < 60; ++night) {
    const auto more = nights(1, night);
    left.insert(left.end(), more.begin(), more.end());
    left = kept(left, night + 1, config);
  }
  EXPECT_EQ(names(left), names(kept(nights(60), 60, config)));
}

TEST(History, DoesNotTouchNewRuns) {
  std::vector<PosedScan> scans = nights(50);
  const auto more = nights(30, 50);
  scans.insert(scans.end(), more.begin(), more.end());
  const auto left = names(kept(scans, 50, {.passes_per_place = 5}));
  auto expected = names(kept(nights(50), 50, {.passes_per_place = 5}));
  for (const auto& name : names(more)) expected.push_back(name);
  EXPECT_EQ(left, expected);
}

/// Of 400 nights 60 are drawn, over and over with other runs: of weights that halve in 30 nights
/// those of the last 30 are drawn more often than of the 30 before, by less than twice, since each
/// is drawn once.
TEST(History, ForgetsWhatIsOldFirst) {
  std::map<int, int> of_age;
  for (int repeat = 0; repeat < 20; ++repeat) {
    auto scans = nights(400);
    for (PosedScan& scan : scans) {
      scan.run += 1000 * repeat;
      scan.scan.stamp.ns += 1'000'000'000'000'000 * repeat;
      scan.map_from_robot.y += 10.0 * repeat;
    }
    std::set<int> runs;
    for (const PosedScan& scan : kept(scans, 1'000'000, {.passes_per_place = 60})) {
      runs.insert(scan.run % 1000);
    }
    for (const int run : runs) ++of_age[(399 - run) / 30];
  }
  EXPECT_GT(of_age[0], 20 * 30 * 0.7);
  EXPECT_GT(of_age[0], of_age[1]);
  EXPECT_GT(of_age[1], 1.2 * of_age[2]);
  EXPECT_GT(of_age[2], 1.4 * of_age[3]);
  EXPECT_GT(of_age[3], 0) << "some of what is old stays";
  EXPECT_EQ(of_age.count(13), 0U);
}

TEST(History, OfStampsThatBeginAnewKeepsTheNewestRuns) {
  std::vector<PosedScan> scans = nights(20);
  for (PosedScan& scan : scans) scan.scan.stamp.ns %= 86'400'000'000'000;
  for (const PosedScan& scan : kept(scans, 20, {.passes_per_place = 4})) EXPECT_GE(scan.run, 16);
}

TEST(History, OfRunsInAnotherOrderIsTheSame) {
  const auto kept_stamps = [](std::vector<PosedScan> scans) {
    std::set<std::int64_t> stamps;
    for (const PosedScan& scan : kept(scans, 1000, {.passes_per_place = 4})) {
      stamps.insert(scan.scan.stamp.ns);
    }
    return stamps;
  };
  std::vector<PosedScan> other = nights(50);
  for (PosedScan& scan : other) scan.run = (scan.run * 7 + 3) % 50;
  EXPECT_EQ(kept_stamps(other), kept_stamps(nights(50)));
}

TEST(History, TakesAnyHeading) {
  std::vector<PosedScan> scans = nights(3);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    scans[i].map_from_robot.theta = -9.0 + 0.15 * static_cast<double>(i);
    scans[i].map_from_robot.x = -1.0 - 1e-9 * static_cast<double>(i);
  }
  EXPECT_EQ(kept(scans, 3, {.passes_per_place = 3}).size(), scans.size());
}

}  // namespace
}  // namespace strata
