// SPDX-License-Identifier: Apache-2.0
/// What an online learner gives up when memory is short, and what it keeps when sub-maps grow.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/online_learner.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

constexpr double kCell_m = 0.05;

/// One drive along the corridor in each of the worlds, in one long run; 60 s and more in between.
std::vector<PosedScan> drives(const std::vector<test_world::ToyWorld>& worlds) {
  std::vector<PosedScan> scans;
  for (std::size_t v = 0; v < worlds.size(); ++v) {
    RandomStream random(11, StreamId::kTest, v);
    const double y = random.uniform(1.1, 1.4);
    test_world::ToyRobot{}.drive(worlds[v], {1.0, y, 0.0}, {10.0, y, 0.0}, 0,
                                 100.0 * static_cast<double>(v), {}, random, scans);
  }
  return scans;
}

/// Whether a wall between the two points is there in the configuration.
bool has_wall(const Configuration& configuration, const test_world::Wall& wall) {
  int known = 0;
  int occupied = 0;
  constexpr int kSteps = 10;
  for (int i = 1; i < kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    const Cell cell = cell_at(
        {wall.x0 + part * (wall.x1 - wall.x0), wall.y0 + part * (wall.y1 - wall.y0)}, kCell_m);
    float most = -1.0F;
    for (int dy = -1; dy <= 1; ++dy) {
      const Cell near{cell.x, cell.y + dy};
      const float value = configuration.reflection.get(near);
      if (is_known(value)) most = std::max(most, value);
    }
    known += most >= 0.0F ? 1 : 0;
    occupied += most > 0.5F ? 1 : 0;
  }
  return known > 0 && 2 * occupied > known;
}

std::size_t configurations_with(const Submap& submap, const test_world::Wall& wall) {
  return static_cast<std::size_t>(
      std::count_if(submap.configurations.begin(), submap.configurations.end(),
                    [&](const Configuration& each) { return has_wall(each, wall); }));
}

/// Two places of a box against the lower wall, side by side, and the side that the robot sees.
constexpr double kBoxTopM = 0.4;
constexpr test_world::Wall kLeftBox{5.3, kBoxTopM, 5.8, kBoxTopM};
constexpr test_world::Wall kRightBox{5.9, kBoxTopM, 6.4, kBoxTopM};

test_world::ToyWorld corridor_with_box(const test_world::Wall& top) {
  test_world::ToyWorld world = test_world::corridor_with_door(true);
  world.add_box(top.x0, 0.0, top.x1, top.y0);
  return world;
}

PatchMap learn_online(const std::vector<PosedScan>& scans, double memory_mb, OnlineStatus& status) {
  OnlineConfig config;
  config.memory_mb = memory_mb;
  OnlinePatchLearner learner({}, config, test_world::map_of(scans));
  for (const PosedScan& scan : scans) learner.add(scan);
  const PatchMap map = learner.finish();
  status = learner.status();
  return map;
}

TEST(OnlineForgetting, GivesUpTheConfigurationSeenLongestAgoFirst) {
  const test_world::ToyWorld none = test_world::corridor_with_door(true);
  const test_world::ToyWorld left = corridor_with_box(kLeftBox);
  const test_world::ToyWorld right = corridor_with_box(kRightBox);
  const auto scans = drives({none, left, none, left, none, right, none, right, none, right, none});
  OnlineStatus status;
  const PatchMap all = learn_online(scans, 256.0, status);
  ASSERT_EQ(all.submaps.size(), 1U);
  ASSERT_EQ(all.submaps[0].configurations.size(), 3U);
  EXPECT_EQ(configurations_with(all.submaps[0], kLeftBox), 1U);
  EXPECT_EQ(configurations_with(all.submaps[0], kRightBox), 1U);
  EXPECT_EQ(status.forgotten_configurations, 0U);

  const PatchMap little = learn_online(scans, 1.0, status);
  EXPECT_GT(status.forgotten_configurations, 0U);
  ASSERT_EQ(little.submaps.size(), 1U);
  EXPECT_EQ(little.submaps[0].configurations.size(), 2U) << "two are always kept";
  EXPECT_EQ(configurations_with(little.submaps[0], kLeftBox), 0U);
  EXPECT_EQ(configurations_with(little.submaps[0], kRightBox), 1U);
}

// First only the door changes, then only a box beside it: the sub-map of both still knows the open
// door, of which no scan is left.
TEST(OnlineForgetting, AGrownSubmapStillKnowsWhatForgottenScansSaw) {
  const test_world::Wall door{5.05, 2.4, 5.95, 2.4};
  const test_world::Wall box{6.2, 1.9, 6.7, 1.9};
  const test_world::ToyWorld closed = test_world::corridor_with_door(true);
  const test_world::ToyWorld open = test_world::corridor_with_door(false);
  test_world::ToyWorld boxed = closed;
  boxed.add_box(box.x0, box.y0, box.x1, 2.3);
  std::vector<test_world::ToyWorld> worlds;
  for (int i = 0; i < 3; ++i) worlds.insert(worlds.end(), {closed, open});
  for (int i = 0; i < 8; ++i) worlds.insert(worlds.end(), {closed, boxed});
  const auto scans = drives(worlds);
  OnlineConfig config;
  config.memory_mb = 4.0;
  OnlinePatchLearner learner({}, config, test_world::map_of(scans));
  const Cell at_box = cell_at({6.6, 1.95}, kCell_m);
  const Cell at_door = cell_at({5.7, 2.4}, kCell_m);
  std::size_t door_alone = 0;
  for (const PosedScan& scan : scans) {
    if (!learner.add(scan)) continue;
    for (const Submap& submap : learner.map().submaps) {
      if (submap.rect.contains(at_door) && !submap.rect.contains(at_box)) ++door_alone;
    }
  }
  EXPECT_GT(door_alone, 0U) << "at first";
  EXPECT_LT(learner.status().scans, 8 * scans.size() / worlds.size()) << "the open door's are gone";
  const PatchMap map = learner.finish();
  ASSERT_EQ(map.submaps.size(), 1U);
  const Submap& both = map.submaps[0];
  ASSERT_TRUE(both.rect.contains(at_door) && both.rect.contains(at_box));
  EXPECT_GE(configurations_with(both, box), 1U);
  EXPECT_LT(configurations_with(both, door), both.configurations.size()) << "it is open in one";
}

}  // namespace
}  // namespace strata::patch
