// SPDX-License-Identifier: Apache-2.0
#include "core/patch/sequences.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/patch/sequence_vectors.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

constexpr double kSequenceCell_m = 0.05;

std::vector<PosedScan> standing(double seconds, double period_s, int run = 0) {
  test_world::ToyWorld world;
  world.add_box(-4.0, -4.0, 4.0, 4.0);
  RandomStream random(7, StreamId::kTest);
  std::vector<PosedScan> scans;
  for (double t = 0.0; t < seconds; t += period_s) {
    scans.push_back(test_world::ToyRobot{}.scan_at(world, {0.0, 0.0, 0.0}, random));
    scans.back().run = run;
    scans.back().scan.stamp = Stamp::from_seconds(t);
  }
  return scans;
}

const CellRect kBeside{{20, -10}, {40, 10}};  // 1 m x 1 m, 1 m to the right of the origin

TEST(Clip, AgreesWithDenseSamplingOfTheSegment) {
  for (std::uint32_t i = 0; i < 2000; ++i) {
    RandomStream random(11, StreamId::kTest, 0, i);
    const CellRect rect{{-10, -5}, {7, 12}};
    const Eigen::Vector2d a(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
    const Eigen::Vector2d b(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
    double enter = 0.0;
    double leave = 0.0;
    const bool touches = clip_to_rect(a, b, rect, kSequenceCell_m, enter, leave);
    for (int k = 0; k <= 200; ++k) {
      const double t = k / 200.0;
      const Eigen::Vector2d p = a + t * (b - a);
      const bool inside = p.x() >= -0.5 && p.x() < 0.35 && p.y() >= -0.25 && p.y() < 0.6;
      const bool clipped = touches && t >= enter && t <= leave;
      if (std::abs(t - enter) > 1e-9 && std::abs(t - leave) > 1e-9) {
        EXPECT_EQ(inside, clipped) << "segment " << i << " t " << t;
      }
    }
  }
}

TEST(Sequences, AreCutAfterThirtySeconds) {
  const auto scans = standing(70.0, 0.2);
  const std::vector<CellRect> rects{kBeside};
  for (const SequenceMode mode : {SequenceMode::kVisibility, SequenceMode::kEntered}) {
    SequenceConfig config;
    config.mode = mode;
    const auto sequences = find_sequences(scans, rects, kSequenceCell_m, config, {});
    ASSERT_EQ(sequences[0].size(), 3U);
    std::size_t total = 0;
    for (const Sequence& s : sequences[0]) {
      total += s.scans.size();
      const double length =
          (scans[s.scans.back()].scan.stamp - scans[s.scans.front()].scan.stamp).seconds();
      EXPECT_LE(length, 30.0);
    }
    EXPECT_EQ(total, scans.size()) << "a new one opens at once";
  }
}

TEST(Sequences, EndWithTheRunAndAtPauses) {
  auto scans = standing(4.0, 0.2, 0);
  for (PosedScan& scan : standing(4.0, 0.2, 1)) scans.push_back(scan);
  for (PosedScan& scan : standing(4.0, 0.2, 1)) {
    scan.scan.stamp = scan.scan.stamp + Duration::from_seconds(6.0);
    scans.push_back(scan);
  }
  const std::vector<CellRect> rects{kBeside};
  const auto sequences = find_sequences(scans, rects, kSequenceCell_m, {}, {});
  ASSERT_EQ(sequences[0].size(), 3U);
  for (const Sequence& s : sequences[0]) EXPECT_EQ(s.scans.size(), 20U);
}

TEST(Sequences, OfASlowScannerOutliveItsPeriod) {
  const std::vector<CellRect> rects{kBeside};
  for (const double period_s : {1.5, 4.0, 10.0}) {
    SequenceConfig config;
    config.max_duration_s = 60.0;
    const auto scans = standing(60.0, period_s);
    const auto found = find_sequences(scans, rects, kSequenceCell_m, config, {});
    ASSERT_EQ(found[0].size(), 1U) << period_s;
    EXPECT_EQ(found[0].front().scans.size(), scans.size());
  }
  // A hole of many periods is one all the same.
  auto scans = standing(12.0, 1.5);
  for (PosedScan& scan : standing(12.0, 1.5)) {
    scan.scan.stamp = scan.scan.stamp + Duration::from_seconds(17.0);
    scans.push_back(scan);
  }
  EXPECT_EQ(find_sequences(scans, rects, kSequenceCell_m, {}, {})[0].size(), 2U);
  // So is leaving: a scan in between that does not see the place.
  scans = standing(24.0, 1.5);
  scans[8].map_from_robot = {500.0, 0.0, 0.0};
  EXPECT_EQ(find_sequences(scans, rects, kSequenceCell_m, {}, {})[0].size(), 2U);
}

TEST(Sequences, ShortOnesAreDropped) {
  const auto scans = standing(0.7, 0.2);
  ASSERT_EQ(scans.size(), 4U);
  const std::vector<CellRect> rects{kBeside};
  EXPECT_TRUE(find_sequences(scans, rects, kSequenceCell_m, {}, {})[0].empty());
}

TEST(Sequences, VisibilityNeedsEnoughBeamsOnTheRectangle) {
  const auto scans = standing(4.0, 0.2);
  // 1 m x 1 m seen from 1 m to its nearer side: 2 atan(0.5 / 1) = 53 degrees, 53 beams.
  const std::vector<CellRect> rects{kBeside, {{2000, 0}, {2020, 20}}};
  SequenceConfig config;
  config.min_beams_per_scan = 50;
  EXPECT_EQ(find_sequences(scans, rects, kSequenceCell_m, config, {})[0].size(), 1U);
  config.min_beams_per_scan = 57;
  EXPECT_TRUE(find_sequences(scans, rects, kSequenceCell_m, config, {})[0].empty());
  EXPECT_TRUE(find_sequences(scans, rects, kSequenceCell_m, {}, {})[1].empty());
}

TEST(Sequences, EnteredModeFollowsTheRobot) {
  const auto scans = standing(4.0, 0.2);
  SequenceConfig config;
  config.mode = SequenceMode::kEntered;
  const std::vector<CellRect> rects{kBeside, {{21, -10}, {41, 10}}};
  const auto sequences = find_sequences(scans, rects, kSequenceCell_m, config, {});
  EXPECT_EQ(sequences[0].size(), 1U) << "1 m away, within the margin";
  EXPECT_TRUE(sequences[1].empty()) << "5 cm beyond it";
}

TEST(SequenceCounts, EqualTheCountingMapInsideTheRectangle) {
  test_world::ToyWorld world = test_world::corridor_with_door(false);
  RandomStream random(3, StreamId::kTest);
  std::vector<PosedScan> scans;
  test_world::ToyRobot{}.drive(world, {4.0, 1.2, 0.3}, {6.5, 1.1, 0.5}, 0, 0.0, {}, random, scans);
  CountingMap full(kSequenceCell_m);
  Sequence all;
  for (std::uint32_t i = 0; i < scans.size(); ++i) {
    full.add(scans[i]);
    all.scans.push_back(i);
  }
  const CellRect rect{{90, 40}, {130, 75}};
  const Grid<CellCounts> counts = count_sequence(scans, all, rect, kSequenceCell_m, {});
  double evidence = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const CellCounts& expected = full.cells().get(counts.cell(i));
    EXPECT_EQ(counts.values()[i].hits, expected.hits);
    EXPECT_NEAR(counts.values()[i].misses, expected.misses, 1e-6);
    evidence += expected.total();
  }
  EXPECT_GT(evidence, 1000.0);
}

TEST(SequenceVectors, FeatureIsTheGreatestKnownNeighbourSaturated) {
  ReflectionGrid grid = make_reflection_grid(kSequenceCell_m, {{0, 0}, {12, 12}});
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) grid.at({x, y}) = 0.1F;
  }
  grid.at({3, 3}) = 0.125F;
  grid.at({9, 9}) = 0.75F;
  const std::vector<Cell> cells{{2, 2}, {9, 9}, {9, 10}, {11, 2}};
  const std::vector<float> features = feature_vector(grid, cells);
  EXPECT_EQ(features[0], 0.25F);
  EXPECT_EQ(features[1], 1.0F);
  EXPECT_EQ(features[2], 1.0F) << "unseen beside a surface";
  EXPECT_FALSE(is_known(features[3]));
}

TEST(SequenceVectors, CellsInAShadowAreNotFree) {
  // Seen from one side, the back of an object is unknown, though free cells adjoin it.
  ReflectionGrid grid = make_reflection_grid(kSequenceCell_m, {{0, 0}, {9, 9}});
  for (int y = 0; y < 9; ++y) {
    for (int x = 2; x < 5; ++x) grid.at({x, y}) = 0.0F;
  }
  const std::vector<Cell> cells{{3, 4}, {4, 4}, {5, 4}};
  const std::vector<float> features = feature_vector(grid, cells);
  EXPECT_EQ(features[0], 0.0F);
  EXPECT_FALSE(is_known(features[1])) << "beside the shadow, where a surface may be";
  EXPECT_FALSE(is_known(features[2]));
}

TEST(SequenceVectors, FreeCellsNearASurfaceMayBeThatSurfaceDisplaced) {
  ReflectionGrid grid = make_reflection_grid(kSequenceCell_m, {{0, 0}, {12, 12}});
  for (float& m : grid.values()) m = 0.0F;
  for (int y = 0; y < 12; ++y) grid.at({2, y}) = 1.0F;
  const std::vector<Cell> cells{{3, 6}, {4, 6}, {5, 6}, {6, 6}};
  const std::vector<float> features = feature_vector(grid, cells);
  EXPECT_EQ(features[0], 1.0F);
  EXPECT_FALSE(is_known(features[1]));
  EXPECT_FALSE(is_known(features[2]));
  EXPECT_EQ(features[3], 0.0F);
}

TEST(SequenceVectors, FilterKeepsWhatStaysAndDropsWhatPasses) {
  Grid<CellCounts> counts(kSequenceCell_m, {{0, 0}, {4, 1}});
  counts.at({0, 0}) = {9.0, 0.0};
  counts.at({1, 0}) = {1.0, 19.0};
  counts.at({2, 0}) = {0.2, 0.2};
  counts.at({3, 0}) = {5.0, 5.0};
  const ReflectionGrid m = filter_counts(counts, 0.9, 0.5);
  EXPECT_EQ(m.get({0, 0}), 1.0F);
  EXPECT_EQ(m.get({1, 0}), 0.0F);
  EXPECT_FALSE(is_known(m.get({2, 0})));
  EXPECT_NEAR(m.get({3, 0}), (0.9 * 0.5 - 0.1) / 0.8, 1e-6);
}

}  // namespace
}  // namespace strata::patch
