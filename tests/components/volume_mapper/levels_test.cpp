// SPDX-License-Identifier: Apache-2.0
/// Time levels of the live map.
#include <chrono>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "components/volume_mapper/live_levels.hpp"
#include "core/base/error.hpp"
#include "core/volume/level_tree.hpp"
#include "tests/components/volume_mapper/robot.hpp"

namespace strata::volume_mapper {
namespace {

using volume::VoxelLevel;

octomap::OcTree level_tree_of(const LiveLevels& levels, VoxelLevel level) {
  const std::string data = volume::level_message_data(levels.memory(), level);
  Octomap message;
  message.resolution(0.1);
  message.data().assign(data.begin(), data.end());
  return tree_of(message);
}

/// Sees a wall at x, from the origin.
void see(LiveLevels& levels, double time_s, float x) {
  WorkerPool pool(1);
  volume::Cloud cloud;
  cloud.stamp = Stamp::from_seconds(time_s);
  cloud.map_from_sensor.translation = {0.05, 0.05, 0.05};
  cloud.points_m = wall(x);
  levels.see(cloud, {}, pool);
}

TEST(LiveLevels, TellWhatWasThereOfLateFromWhatLongWas) {
  LiveLevels levels({});
  double time_s = 0.0;
  for (int i = 0; i < 20; ++i) see(levels, time_s += 1.0, 2.0F);
  for (int i = 0; i < 4; ++i) see(levels, time_s += 1.0, 4.0F);  // the wall is gone
  EXPECT_FALSE(is_occupied(level_tree_of(levels, VoxelLevel::kShort), 2.05, 0.05, 0.05));
  EXPECT_TRUE(is_occupied(level_tree_of(levels, VoxelLevel::kMid), 2.05, 0.05, 0.05));
  EXPECT_TRUE(is_occupied(level_tree_of(levels, VoxelLevel::kLong), 2.05, 0.05, 0.05));
  for (int i = 0; i < 12; ++i) see(levels, time_s += 1.0, 4.0F);
  EXPECT_FALSE(is_occupied(level_tree_of(levels, VoxelLevel::kMid), 2.05, 0.05, 0.05));
  const octomap::OcTree longest = level_tree_of(levels, VoxelLevel::kLong);
  EXPECT_TRUE(is_occupied(longest, 2.05, 0.05, 0.05));
  EXPECT_TRUE(is_occupied(longest, 4.05, 0.05, 0.05)) << "all that it ever saw there";
  EXPECT_NE(longest.search(1.05, 0.05, 0.05), nullptr) << "free space is told";
  EXPECT_EQ(longest.search(-1.05, 0.05, 0.05), nullptr) << "nobody looked";
}

TEST(LiveLevels, DoNotDependOnHowManyCloudsASecondCome) {
  LiveLevels slow({});
  LiveLevels fast({});
  for (int i = 0; i < 80; ++i) {
    const float x = i < 60 ? 2.0F : 4.0F;
    if (i % 10 == 0) see(slow, 0.1 * i, x);
    see(fast, 0.1 * i, x);
  }
  const auto middle = volume::VoxelLattice(0.1).key_at({2.05F, 0.05F, 0.05F});
  for (const auto& [level, name] : kLevels) {
    EXPECT_EQ(fast.memory().occupancy(*middle, level), slow.memory().occupancy(*middle, level))
        << name;
  }
  EXPECT_NE(slow.memory().occupancy(*middle, VoxelLevel::kShort), 1.0);
  // A bag that starts again.
  see(fast, 0.0, 2.0F);
  EXPECT_GT(fast.memory().occupancy(*middle, VoxelLevel::kShort),
            slow.memory().occupancy(*middle, VoxelLevel::kShort));
}

TEST(VolumeMapper, PublishesItsLevelsOnTopicsOfTheirOwn) {
  const auto participant = test::make_participant();
  test::Collector<Octomap> of_late(participant, "/octomap_level/short", "latched");
  test::Collector<Octomap> for_long(participant, "/octomap_level/long", "latched");
  Robot robot("publish_period_s: 0, has_levels: true, level_period_s: 0, short_clouds: 0.5");
  robot.move(1.0, 0.0);
  robot.move(2.0, 0.0);
  const auto see_until_told = [&](double time_s, float x, std::size_t maps) {
    robot.see(time_s, wall(x));
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (for_long.wait_for(maps, std::chrono::milliseconds(20)).size() < maps &&
           std::chrono::steady_clock::now() < patience) {
      robot.tick();
    }
  };
  see_until_told(1.2, 2.1F, 1);
  see_until_told(1.3, 2.1F, 2);
  see_until_told(1.4, 4.1F, 3);
  const auto late = of_late.wait_for(3);
  const auto longest = for_long.wait_for(3);
  ASSERT_EQ(late.size(), 3U);
  ASSERT_EQ(longest.size(), 3U);
  EXPECT_EQ(longest[2].id(), "OcTree");
  EXPECT_EQ(longest[2].header().frame_id(), "map");
  EXPECT_TRUE(is_occupied(tree_of(late[1]), 2.35, 0.05, 0.05));
  EXPECT_FALSE(is_occupied(tree_of(late[2]), 2.35, 0.05, 0.05));
  EXPECT_TRUE(is_occupied(tree_of(longest[2]), 2.35, 0.05, 0.05));
  EXPECT_TRUE(is_occupied(tree_of(late[2]), 4.35, 0.05, 0.05));
}

TEST(VolumeMapper, RefusesLevelsOutOfOrder) {
  EXPECT_THROW(Robot("has_levels: true, short_clouds: 20, mid_clouds: 10"), ConfigError);
}

}  // namespace
}  // namespace strata::volume_mapper
