// SPDX-License-Identifier: Apache-2.0
#include "core/grid/counting_map.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/grid/count_scans.hpp"
#include "core/random/stream.hpp"
#include "tests/core/grid/clip_reference.hpp"
#include "tests/core/grid/log_odds_map.hpp"

namespace strata {
namespace {

constexpr double kResolution = 0.1;
constexpr float kNoReturn = std::numeric_limits<float>::infinity();

PosedScan random_scan(RandomStream& random, bool with_labels) {
  PosedScan posed;
  posed.map_from_robot = {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0),
                          random.uniform(-3.0, 3.0)};
  posed.scan.robot_from_laser = {0.2, 0.1, 0.3};
  posed.scan.angle_min_rad = -2.0F;
  posed.scan.angle_increment_rad = 0.13F;
  posed.scan.range_min_m = 0.05F;
  posed.scan.range_max_m = 5.0F;
  for (int i = 0; i < 30; ++i) {
    float range = static_cast<float>(random.uniform(0.0, 4.0));
    if (random.bernoulli(0.1)) range = kNoReturn;
    if (random.bernoulli(0.1)) range = std::numeric_limits<float>::quiet_NaN();
    if (random.bernoulli(0.05)) range = -kNoReturn;
    posed.scan.ranges_m.push_back(range);
    if (with_labels) posed.static_probability.push_back(static_cast<float>(random.uniform()));
  }
  return posed;
}

/// The counting model beam by beam and cell by cell, straight from eqs. (1.12) to (1.15).
void count_slowly(const PosedScan& posed, const CountingOptions& options,
                  std::map<Cell, CellCounts>& cells) {
  const Pose2 laser = posed.map_from_laser();
  for (std::size_t n = 0; n < posed.scan.size(); ++n) {
    const float reading = posed.scan.ranges_m[n];
    if (std::isnan(reading) || reading < posed.scan.range_min_m) continue;
    bool hit = reading < posed.scan.range_max_m;
    const auto& dropped = posed.scan.drop_outs;
    double range = static_cast<double>(reading);
    if (!hit && !options.believes_no_returns) continue;
    if (!hit && options.no_return_free_range_m > 0.0) {
      range = options.no_return_free_range_m;
    } else if (!hit) {
      range = std::count(dropped.begin(), dropped.end(), n) > 0
                  ? 0.0
                  : static_cast<double>(posed.scan.free_range_m);
    }
    if (options.max_range_m > 0.0 && range > options.max_range_m) {
      range = options.max_range_m;
      hit = false;
    }
    if (range <= 0.0) continue;
    const double angle = laser.theta + posed.scan.bearing_rad(n);
    const Eigen::Vector2d from = laser.translation();
    const Eigen::Vector2d to = from + range * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Cell end = cell_at(to, kResolution);
    for (const auto& [cell, length] : test::clip_lengths(from, to, kResolution)) {
      if (!(hit && cell == end)) cells[cell].misses += length / kResolution;
    }
    if (!hit) continue;
    const double e =
        posed.static_probability.empty() ? 1.0 : static_cast<double>(posed.static_probability[n]);
    cells[end].hits += e;
    cells[end].misses += 1.0 - e;
  }
}

void expect_equal(const CountingMap& map, const std::map<Cell, CellCounts>& expected) {
  for (const auto& [cell, counts] : expected) {
    if (counts.total() > 1e-9) {
      ASSERT_TRUE(map.cells().contains(cell));
    }
  }
  for (std::size_t i = 0; i < map.cells().size(); ++i) {
    const auto found = expected.find(map.cells().cell(i));
    const CellCounts counts = found == expected.end() ? CellCounts{} : found->second;
    ASSERT_NEAR(map.cells().get(map.cells().cell(i)).hits, counts.hits, 1e-9);
    ASSERT_NEAR(map.cells().get(map.cells().cell(i)).misses, counts.misses, 1e-8);
  }
}

TEST(CountingMap, EqualsTheSlowCountCellByCell) {
  RandomStream random(1, StreamId::kTest);
  for (const bool with_labels : {false, true}) {
    for (const CountingOptions options :
         {CountingOptions{}, CountingOptions{1.5, 0.0}, CountingOptions{0.0, 2.0},
          CountingOptions{3.5, 2.0}, CountingOptions{.believes_no_returns = false}}) {
      CountingMap map(kResolution);
      std::map<Cell, CellCounts> expected;
      for (int i = 0; i < 60; ++i) {
        PosedScan scan = random_scan(random, with_labels);
        if (i % 2 == 1) scan.scan.free_range_m = 3.0F;
        for (std::uint32_t beam = 0; i % 4 == 3 && beam < scan.scan.size(); ++beam) {
          if (random.bernoulli(0.3)) scan.scan.drop_outs.push_back(beam);
        }
        map.add(scan, options);
        count_slowly(scan, options, expected);
      }
      expect_equal(map, expected);
    }
  }
}

TEST(CountingMap, TakesAScanOutAgain) {
  RandomStream random(2, StreamId::kTest);
  CountingMap map(kResolution);
  std::map<Cell, CellCounts> expected;
  const PosedScan kept = random_scan(random, true);
  const PosedScan taken = random_scan(random, true);
  map.add(kept);
  map.add(taken);
  map.add(taken, {}, -1.0);
  count_slowly(kept, {}, expected);
  expect_equal(map, expected);
}

/// A scan of walls all round at that range.
PosedScan round_scan(float range_m, int beams) {
  PosedScan posed;
  posed.scan.angle_min_rad = -3.0F;
  posed.scan.angle_increment_rad = 6.0F / static_cast<float>(beams);
  posed.scan.range_max_m = 20.0F;
  posed.scan.ranges_m.assign(static_cast<std::size_t>(beams), range_m);
  return posed;
}

TEST(CountingMap, FadesByScansHoweverManyBeamsCrossACell) {
  constexpr double kScans = 50.0;
  for (const int beams : {40, 400, 4000}) {
    CountingMap map(kResolution);
    // With a million as much as scans bring, what these bring does not count.
    map.add(round_scan(8.0F, beams), {}, 1e6);
    const Grid<CellCounts> full = map.cells().dense();
    for (int i = 0; i < 10; ++i) {
      map.add_fading(round_scan(8.0F, beams), {}, BeamWeights::kAllStatic, kScans);
    }
    const double expected = std::pow(1.0 - 1.0 / kScans, 10.0);
    int cells = 0;
    double mean = 0.0;
    for (std::size_t i = 0; i < full.size(); ++i) {
      const Cell cell = full.cell(i);
      const double total = full.values()[i].total();
      if (total < 0.3e6) continue;
      const double left = map.cells().get(cell).total() / total;
      EXPECT_GT(left, std::pow(expected, 4.0)) << beams;
      EXPECT_LE(left, 1.0) << beams;
      mean += left;
      ++cells;
    }
    ASSERT_GT(cells, 1000) << beams;
    EXPECT_NEAR(mean / cells, expected, 0.06) << beams;
  }
}

TEST(CountingMap, FadingLeavesCellsAloneThatTheScanDoesNotLookAt) {
  CountingMap map(kResolution);
  map.add(round_scan(8.0F, 400));
  const Grid<CellCounts> before = map.cells().dense();
  for (int i = 0; i < 20; ++i) {
    map.add_fading(round_scan(2.0F, 400), {}, BeamWeights::kAllStatic, 10.0);
  }
  int cells = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before.center(before.cell(i)).norm() < 2.2) continue;
    EXPECT_EQ(map.cells().get(before.cell(i)).total(), before.values()[i].total());
    cells += before.values()[i].total() > 0.0 ? 1 : 0;
  }
  EXPECT_GT(cells, 1000);
}

TEST(CountingMap, CountsAllBeamsWhenLabelsAreToBeIgnored) {
  RandomStream random(3, StreamId::kTest);
  PosedScan scan = random_scan(random, true);
  CountingMap map(kResolution);
  map.add(scan, {}, 1.0, BeamWeights::kAllStatic);
  scan.static_probability.clear();
  std::map<Cell, CellCounts> expected;
  count_slowly(scan, {}, expected);
  expect_equal(map, expected);
}

TEST(CountingMap, ReflectionIsTheShareOfHitsAndUnknownWithoutEvidence) {
  Grid<CellCounts> cells(kResolution, {{0, 0}, {4, 1}});
  cells.values() = {{3.0, 1.0}, {0.0, 0.4}, {0.0, 0.5}, {2.0, 0.0}};
  const ReflectionGrid map = CountingMap(TiledGrid(cells)).reflection();
  EXPECT_EQ(map.values()[0], 0.75F);
  EXPECT_FALSE(is_known(map.values()[1]));
  EXPECT_EQ(map.values()[2], 0.0F);
  EXPECT_EQ(map.values()[3], 1.0F);
}

TEST(CountScans, EqualsAddingOneScanAfterTheOther) {
  RandomStream random(4, StreamId::kTest);
  std::vector<PosedScan> scans;
  for (int i = 0; i < 700; ++i) scans.push_back(random_scan(random, true));
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{127}, scans.size()}) {
    const std::span<const PosedScan> some(scans.data(), count);
    CountingMap expected(kResolution);
    for (const PosedScan& scan : some) expected.add(scan);
    WorkerPool one(1);
    const CountingMap map =
        count_scans(some, kResolution, {}, BeamWeights::kStaticProbability, one);
    for (std::size_t i = 0; i < map.cells().size(); ++i) {
      const CellCounts& counts = expected.cells().get(map.cells().cell(i));
      // Stretches are added in another order than scans; short logs are one stretch.
      const double tolerance = count < 128 ? 0.0 : 1e-9;
      ASSERT_NEAR(map.cells().get(map.cells().cell(i)).hits, counts.hits, tolerance);
      ASSERT_NEAR(map.cells().get(map.cells().cell(i)).misses, counts.misses, tolerance);
    }
    for (const int threads : {2, 8}) {
      WorkerPool pool(threads);
      const CountingMap again =
          count_scans(some, kResolution, {}, BeamWeights::kStaticProbability, pool);
      ASSERT_EQ(again.cells().rect(), map.cells().rect());
      for (std::size_t i = 0; i < map.cells().size(); ++i) {
        ASSERT_EQ(again.cells().get(again.cells().cell(i)).hits,
                  map.cells().get(map.cells().cell(i)).hits);
        ASSERT_EQ(again.cells().get(again.cells().cell(i)).misses,
                  map.cells().get(map.cells().cell(i)).misses);
      }
    }
  }
}

TEST(LogOddsMap, AddsLogOddsOfHitsAndOfPassedLengths) {
  LogOddsConfig config;
  config.clamp_log_odds = 1e6;
  LogOddsMap map(kResolution, config);
  CountingMap counts(kResolution);
  RandomStream random(5, StreamId::kTest);
  for (int i = 0; i < 40; ++i) {
    const PosedScan scan = random_scan(random, false);
    map.add(scan);
    counts.add(scan);
  }
  const double hit = std::log(config.hit_probability / (1.0 - config.hit_probability));
  const double miss = std::log(config.miss_probability / (1.0 - config.miss_probability));
  for (std::size_t i = 0; i < counts.cells().size(); ++i) {
    const CellCounts& cell = counts.cells().get(counts.cells().cell(i));
    const double expected = cell.hits * hit + cell.misses * miss;
    const float value = map.log_odds().get(counts.cells().cell(i));
    ASSERT_NEAR(value, expected, 1e-4 * (1.0 + std::abs(expected)));
  }
}

TEST(LogOddsMap, ClampsSoThatItCanChangeItsMind) {
  LogOddsMap map(kResolution);
  PosedScan near;
  near.scan.range_max_m = 10.0F;
  near.scan.ranges_m = {1.05F};
  PosedScan far = near;
  far.scan.ranges_m = {2.05F};
  for (int i = 0; i < 1'000; ++i) map.add(near);
  const Cell cell = cell_at({1.05, 0.0}, kResolution);
  EXPECT_NEAR(map.log_odds().at(cell), 6.0, 1e-6);
  EXPECT_TRUE(is_occupied(map.probability().at(cell)));
  for (int i = 0; i < 30; ++i) map.add(far);
  EXPECT_TRUE(is_free(map.probability().at(cell)));
}

TEST(LogOddsMap, RefusesProbabilitiesThatSayEverything) {
  LogOddsConfig config;
  config.hit_probability = 1.0;
  EXPECT_THROW(LogOddsMap(kResolution, config), ConfigError);
}

TEST(CountScans, ReadingsThatNoScannerGivesDoNotGrowTheMap) {
  PosedScan scan;
  scan.scan.angle_increment_rad = 0.5F;
  scan.scan.range_max_m = kNoReturn;
  scan.scan.ranges_m = {2.0F, 1e30F,     3e38F,
                        1e7F, kNoReturn, std::numeric_limits<float>::quiet_NaN()};
  CountingOptions options;
  options.no_return_free_range_m = 3.0;
  WorkerPool pool(1);
  const CountingMap map = count_scans(std::vector<PosedScan>{scan}, kResolution, options,
                                      BeamWeights::kStaticProbability, pool);
  EXPECT_LE(map.cells().rect().width(), 70);
  EXPECT_LE(map.cells().rect().height(), 70);
  EXPECT_EQ(map.cells().get({20, 0}).hits, 1.0);
}

}  // namespace
}  // namespace strata
