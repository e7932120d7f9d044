// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/node_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;
using test_world::range_m;

constexpr float kOpen = std::numeric_limits<float>::infinity();

/// One node at (0, 0) in the room, with the box for the last `with_box` of 400 scans.
TimescaleMemory standing(int with_box, TimescaleConfig config = {}) {
  TimescaleMemory memory(std::move(config), 1);
  for (int t = 0; t < 400; ++t) {
    memory.observe(observe({0.2 * std::sin(0.7 * t), 0.2 * std::cos(0.7 * t), 0.1 * t}, t,
                           t >= 400 - with_box));
  }
  return memory;
}

TEST(NodeMap, ExpectsWhatAScannerNearbyWouldMeasure) {
  const TimescaleMemory memory = standing(0);
  const auto map = memory.decode();
  RandomStream random(5, StreamId::kTest);
  std::vector<double> errors;
  int unknown = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose2 laser{random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), random.uniform(-3, 3)};
    const double bearing = random.uniform(-3.0, 3.0);
    const float expected = map->expected_range_m(map->level_index("long"), laser, bearing);
    if (std::isnan(expected)) {
      ++unknown;
      continue;
    }
    errors.push_back(std::abs(static_cast<double>(expected) -
                              range_m(laser.translation(), laser.theta + bearing, false)));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(unknown, 20);
  EXPECT_LT(errors[errors.size() / 2], 0.03);
  EXPECT_LT(errors[errors.size() * 95 / 100], 0.15);
}

TEST(NodeMap, ShowsANewObjectInTheFastLevelAndNotInTheSlowOne) {
  const TimescaleMemory memory = standing(10);
  const auto map = memory.decode();
  const Pose2 laser{0.0, 0.0, 0.0};
  EXPECT_NEAR(map->expected_range_m(map->level_index("short"), laser, 0.0), 2.0F, 0.1F);
  EXPECT_NEAR(map->expected_range_m(map->level_index("long"), laser, 0.0), 5.0F, 0.1F);
  EXPECT_THROW((void)map->level_index("weekly"), ConfigError);
}

TEST(NodeMap, ForgetsAnObjectThatVanishesBeforeOpenSpace) {
  TimescaleConfig config;
  config.max_range_m = 4.0;
  config.range_bins = 25;
  TimescaleMemory memory(config, 1);
  for (int t = 0; t < 60; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, t < 30));
  const auto map = memory.decode();
  EXPECT_EQ(map->expected_range_m(map->level_index("short"), {0.0, 0.0, 0.0}, 0.0), kOpen);
}

TEST(NodeMap, KnowsNothingBehindWalls) {
  const auto map = standing(0).decode();
  EXPECT_EQ(map->node_at(0, {0.5, 0.5}), 0);
  EXPECT_EQ(map->node_at(0, {4.5, 2.5}), 0);
  EXPECT_NEAR(map->expected_range_m(0, {4.0, 0.0, 0.0}, 0.0), 1.0F, 0.1F);
  for (const double aside : {3.2, 5.0}) {
    EXPECT_EQ(map->node_at(0, {0.0, aside}), -1);
    EXPECT_TRUE(std::isnan(map->expected_range_m(0, {0.0, aside, 0.0}, 0.0)));
  }
  EXPECT_EQ(map->node_at(0, {1e6, 0.0}), -1);
}

TEST(NodeMap, AsksTheNextNodeForWhatTheNearestCannotSee) {
  // From (0, 0) the box at x = 2 to 3 hides the wall at x = 5; from (1, 2.3) one sees past it.
  TimescaleMemory memory({}, 1);
  for (int t = 0; t < 40; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, true));
  const Pose2 laser{0.4, 1.3, 0.0};
  const double bearing = -0.05;  // over the corner of the box
  const double truth = range_m(laser.translation(), bearing, true);
  ASSERT_GT(truth, 4.5);
  const auto alone = memory.decode();
  const auto hidden =
      alone->reach(alone->view(2, laser.translation()), {std::cos(bearing), std::sin(bearing)});
  ASSERT_EQ(hidden.end, NodeOutline::Edge::kHidden);
  EXPECT_LT(hidden.range_m, truth);
  EXPECT_TRUE(std::isnan(alone->expected_range_m(2, laser, bearing)));
  for (int t = 40; t < 80; ++t) memory.observe(observe({1.0, 2.3, 0.0}, t, true));
  ASSERT_EQ(memory.nodes().size(), 2U);
  const auto both = memory.decode();
  EXPECT_NEAR(both->expected_range_m(2, laser, bearing), truth, 0.1);
}

TEST(NodeMap, OfManyNodesExpectsWhatAScannerWouldMeasureAnywhere) {
  TimescaleMemory memory({}, 1);
  for (int t = 0; t < 600; ++t) {
    memory.observe(observe({2.6 * std::sin(0.02 * t), 1.8 * std::cos(0.03 * t), 0.1 * t}, t, true));
  }
  const auto map = memory.decode();
  RandomStream random(6, StreamId::kTest);
  std::vector<double> errors;
  int beams = 0;
  for (int i = 0; i < 4000; ++i) {
    const Pose2 laser{random.uniform(-2.5, 1.8), random.uniform(-2.0, 2.0), 0.0};
    const double bearing = random.uniform(-3.1, 3.1);
    const float expected = map->expected_range_m(2, laser, bearing);
    ++beams;
    if (!std::isfinite(expected)) continue;
    errors.push_back(
        std::abs(static_cast<double>(expected) - range_m(laser.translation(), bearing, true)));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_GT(static_cast<double>(errors.size()), 0.97 * beams);
  EXPECT_LT(errors[errors.size() / 2], 0.03);
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.15);
}

TEST(NodeMap, GivesTheDecodedScanAsAScan) {
  const TimescaleMemory memory = standing(0);
  const auto map = memory.decode();
  const Scan scan = map->expected_scan(2, 0);
  ASSERT_EQ(scan.size(), 360U);
  const Eigen::Vector2d node = map->nodes()[0].position_m;
  int off = 0;
  for (std::size_t i = 0; i < 360; ++i) {
    const double expected = range_m(node, scan.bearing_rad(i), false);
    off += std::abs(static_cast<double>(scan.ranges_m[i]) - expected) < 0.15 ? 0 : 1;
  }
  EXPECT_LE(off, 5);
}

TEST(NodeMap, DrawsWallsWhereTheyAreAndFreeSpaceBetweenThem) {
  const TimescaleMemory memory = standing(0);
  const auto map = memory.decode();
  const ReflectionGrid picture = map->level_map(2, 0.05);
  EXPECT_TRUE(is_free(picture.get(picture.cell_at({1.0, 1.0}))));
  EXPECT_FALSE(is_known(picture.get(picture.cell_at({6.0, 0.0}))));
  double worst_m = 0.0;
  std::size_t occupied = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (!is_occupied(picture.values()[i])) continue;
    const Eigen::Vector2d p = picture.center(picture.cell(i));
    worst_m = std::max(worst_m, std::min({std::abs(p.x() + 4.0), std::abs(p.x() - 5.0),
                                          std::abs(p.y() + 3.0), std::abs(p.y() - 3.0)}));
    ++occupied;
  }
  EXPECT_LT(worst_m, 0.25);
  EXPECT_GT(occupied, 400U);  // 30 m of wall
}

TEST(NodeMap, DrawsWhatTheNearestNodeThatSeesACellSays) {
  const TimescaleMemory memory = standing(0);
  const auto map = memory.decode();
  ASSERT_GT(map->nodes().size(), 0U);
  const ReflectionGrid picture = map->level_map(2, 0.05);
  std::size_t different = 0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (is_occupied(picture.values()[i])) continue;
    const Eigen::Vector2d center = picture.center(picture.cell(i));
    const bool seen =
        std::any_of(map->nodes().begin(), map->nodes().end(), [&](const NodeMap::Node& node) {
          return node.levels[2]->outline.contains(center - node.position_m);
        });
    known += seen ? 1 : 0;
    different += seen != is_free(picture.values()[i]) ? 1 : 0;
  }
  EXPECT_GT(known, 10'000U);
  // Edges that point at the node: contains() takes bearings to within 1e-4 rad.
  EXPECT_LT(different, known / 1'000U);
}

TEST(NodeMap, ReusesWhatHasNotChanged) {
  TimescaleMemory memory = standing(0);
  const auto before = memory.decode();
  memory.observe(observe({0.0, 0.0, 0.0}, 1000.0, false));
  const auto after = memory.decode({}, before.get());
  EXPECT_NE(after->nodes()[0].levels[0], before->nodes()[0].levels[0]);
  EXPECT_EQ(after->nodes()[0].levels[2], before->nodes()[0].levels[2]);
  const auto fresh = memory.decode();
  for (std::size_t level = 0; level < 3; ++level) {
    EXPECT_THAT(after->nodes()[0].levels[level]->scan.range_m,
                testing::Pointwise(testing::NanSensitiveFloatEq(),
                                   fresh->nodes()[0].levels[level]->scan.range_m));
  }
  // Another decoder shares nothing.
  const auto literal = memory.decode(literal_decoding(), before.get());
  EXPECT_NE(literal->nodes()[0].levels[2], before->nodes()[0].levels[2]);
}

TEST(NodeMap, LeavesWhatWasLearnedAMomentAgoOut) {
  TimescaleMemory memory = standing(0);
  const auto before = memory.decode();
  for (int t = 400; t < 420; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, true));
  auto ahead = [](const NodeMap& map) { return map.expected_range_m(0, {0.0, 0.0, 0.0}, 0.0); };
  EXPECT_NEAR(ahead(*memory.decode({}, before.get(), 30.0)), 5.0F, 0.1F);
  EXPECT_NEAR(ahead(*memory.decode({}, before.get())), 2.0F, 0.1F);
  // Once the robot has been elsewhere for longer, it counts.
  memory.observe(observe({-2.0, 0.0, 0.0}, 460.0, true));
  const auto later = memory.decode({}, before.get(), 30.0);
  EXPECT_NEAR(ahead(*later), 2.0F, 0.1F);
  EXPECT_EQ(later->nodes()[1].levels[0]->insertions, 0U);
}

TEST(NodeMap, OfAnEmptyMemoryKnowsNothing) {
  const auto map = TimescaleMemory().decode();
  EXPECT_TRUE(map->nodes().empty());
  EXPECT_EQ(map->node_at(0, {0.0, 0.0}), -1);
  EXPECT_EQ(map->level_map(0).size(), 0U);
}

}  // namespace
}  // namespace strata::memory
