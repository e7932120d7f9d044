// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "memory/nodes/node_map.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr float kOpenEnd_m = std::numeric_limits<float>::infinity();

float range_of(const NodeOutline::Reach& reach) {
  if (reach.end == NodeOutline::Edge::kSurface) return static_cast<float>(reach.range_m);
  return reach.end == NodeOutline::Edge::kOpen ? kOpenEnd_m : kNothing;
}

/// Every edge by itself.
float cast_brute_force(const NodeOutline& outline, const Eigen::Vector2d& from,
                       const Eigen::Vector2d& direction) {
  double best = std::numeric_limits<double>::infinity();
  NodeOutline::Edge met = NodeOutline::Edge::kUnseen;
  for (std::size_t a = 0; a < outline.size(); ++a) {
    const Eigen::Vector2d p = outline.corner_m(a);
    const Eigen::Vector2d along = outline.corner_m((a + 1) % outline.size()) - p;
    const double denominator = direction.x() * along.y() - direction.y() * along.x();
    const Eigen::Vector2d offset = p - from;
    const double t = (offset.x() * along.y() - offset.y() * along.x()) / denominator;
    const double s = (offset.x() * direction.y() - offset.y() * direction.x()) / denominator;
    if (s < -1e-9 || s > 1.0 + 1e-9 || t < 0.0 || t >= best) continue;
    best = t;
    met = outline.edge(a);
  }
  return range_of({best, met});
}

class OutlineOf : public testing::TestWithParam<int> {};

TEST_P(OutlineOf, CastsBeamsAsTryingEveryEdgeDoes) {
  RandomStream random(3, StreamId::kTest);
  const PolarBins bins{GetParam(), 50, 8.0};
  int compared = 0;
  int different = 0;
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<float> ranges;
    double radius = 3.0;
    for (int a = 0; a < GetParam(); ++a) {
      radius = std::clamp(radius + random.normal(0.0, 0.15), 1.0, 7.9);
      const double kind = random.uniform();
      ranges.push_back(kind < 0.05  ? kNothing
                       : kind < 0.1 ? kOpenEnd_m
                                    : static_cast<float>(radius));
    }
    const NodeOutline outline(bins, 0.75, ranges);
    for (int beam = 0; beam < 100; ++beam) {
      const Eigen::Vector2d from(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
      const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
      const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
      const float fast = range_of(outline.cast(from, direction));
      if (!outline.contains(from)) {
        EXPECT_TRUE(std::isnan(fast));
        continue;
      }
      const float slow = cast_brute_force(outline, from, direction);
      ++compared;
      const bool same = std::isnan(slow)   ? std::isnan(fast)
                        : std::isinf(slow) ? std::isinf(fast)
                                           : std::abs(slow - fast) < 1e-3F;
      // A beam exactly through a corner may be given to either edge.
      different += same ? 0 : 1;
    }
  }
  EXPECT_GT(compared, 5000);
  EXPECT_LE(different, compared / 1000);
}

INSTANTIATE_TEST_SUITE_P(Bins, OutlineOf, testing::Values(5, 12, 16, 23, 72));

TEST(NodeOutline, CastsTheBeamsOfAScanAsEachForItself) {
  RandomStream random(4, StreamId::kTest);
  const PolarBins bins{90, 50, 8.0};
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    std::vector<float> ranges;
    for (int a = 0; a < 90; ++a) {
      // Pillars before walls: beams pass behind some corners and end at others.
      ranges.push_back(static_cast<float>(random.uniform() < 0.2 ? random.uniform(1.0, 3.0)
                                                                 : random.uniform(4.0, 7.9)));
    }
    const NodeOutline outline(bins, 0.75, ranges);
    const auto view = outline.view_from({random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)});
    const double from = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double spread = trial % 4 == 0 ? 2.0 * std::numbers::pi : random.uniform(0.1, 6.0);
    const double sense = trial % 2 == 0 ? 1.0 : -1.0;
    std::vector<Eigen::Vector2d> directions;
    for (int beam = 0; beam < 61; ++beam) {
      const double share = trial % 5 == 0 ? random.uniform() : beam / 60.0;  // in any order, too
      const double angle = from + sense * spread * share;
      directions.emplace_back(std::cos(angle), std::sin(angle));
    }
    std::vector<NodeOutline::Reach> together(directions.size());
    outline.cast(view, directions, together);
    for (std::size_t beam = 0; beam < directions.size(); ++beam) {
      const NodeOutline::Reach alone = outline.cast(view, directions[beam]);
      ASSERT_EQ(together[beam].end, alone.end) << beam;
      ASSERT_EQ(together[beam].range_m, alone.range_m) << beam;
    }
  }
}

TEST(NodeOutline, BridgesShortGapsInASurfaceOnly) {
  const PolarBins bins{360, 50, 8.0};
  std::vector<float> ranges(360, 2.0F);
  ranges[10] = ranges[11] = kNothing;
  for (std::size_t a = 50; a < 60; ++a) ranges[a] = kNothing;
  ranges[100] = kNothing;
  std::fill(ranges.begin() + 101, ranges.begin() + 120, 5.0F);
  const NodeOutline outline(bins, 0.75, ranges);
  auto cast = [&](int a) {
    const double angle = bins.center_bearing_rad(a);
    return range_of(outline.cast({0.0, 0.0}, {std::cos(angle), std::sin(angle)}));
  };
  EXPECT_NEAR(cast(10), 2.0F, 0.01F);
  EXPECT_TRUE(std::isnan(cast(55)));
  EXPECT_TRUE(std::isnan(cast(100)));
  EXPECT_NEAR(cast(110), 5.0F, 0.01F);
}

// A free way of 3 m between walls at 2 m: a beam goes on behind its end, unlike at a wall.
TEST(NodeOutline, KnowsAWayToBeFreeWithoutKnowingItsEnd) {
  std::vector<float> ranges(360, 2.0F);
  for (std::size_t a = 80; a < 100; ++a) ranges[a] = -3.0F;
  const NodeOutline outline({360, 50, 8.0}, 0.75, ranges);
  const NodeOutline::Reach ahead = outline.cast({0.0, 0.0}, {0.0, 1.0});
  EXPECT_EQ(ahead.end, NodeOutline::Edge::kHidden);
  EXPECT_NEAR(ahead.range_m, 3.0, 1e-3);
  EXPECT_EQ(outline.cast({0.0, 0.0}, {1.0, 0.0}).end, NodeOutline::Edge::kSurface);
  EXPECT_TRUE(outline.contains({0.0, 2.9}));
  EXPECT_FALSE(outline.contains({0.0, 3.1}));
}

// A bin between a wall and the end of a free way shows no wall, though both are as far.
TEST(NodeOutline, BridgesNoGapToTheEndOfAFreeWay) {
  std::vector<float> ranges(360, 2.0F);
  ranges[80] = kNothing;
  for (std::size_t a = 81; a < 100; ++a) ranges[a] = -2.0F;
  const NodeOutline outline({360, 50, 8.0}, 0.75, ranges);
  EXPECT_EQ(outline.edge(79), NodeOutline::Edge::kHidden);
  EXPECT_EQ(outline.edge(80), NodeOutline::Edge::kHidden);
  EXPECT_EQ(outline.edge(99), NodeOutline::Edge::kHidden);
  EXPECT_EQ(outline.edge(100), NodeOutline::Edge::kSurface);
}

}  // namespace
}  // namespace strata::memory
