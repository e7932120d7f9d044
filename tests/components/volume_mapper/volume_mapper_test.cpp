// SPDX-License-Identifier: Apache-2.0
#include "components/volume_mapper/volume_mapper.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "core/base/error.hpp"
#include "core/volume/volume_map.hpp"
#include "tests/components/volume_mapper/robot.hpp"
#include "tests/support/test_data.hpp"

namespace strata::volume_mapper {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(VolumeMapper, PublishesTheMapOfCloudsAtThePosesOfTf) {
  Robot robot("publish_period_s: 0");
  robot.move(1.0, 0.0);
  robot.move(2.0, 1.0);
  robot.see(1.5, wall(2.1F));  // from x = 0.5 + 0.25
  const auto maps = robot.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0].header().frame_id(), "map");
  EXPECT_TRUE(maps[0].binary());
  EXPECT_EQ(maps[0].id(), "OcTree");
  const octomap::OcTree tree = tree_of(maps[0]);
  EXPECT_TRUE(is_occupied(tree, 2.85, 0.05, 0.05));
  EXPECT_FALSE(is_occupied(tree, 1.8, 0.05, 0.05));
  EXPECT_NE(tree.search(1.8, 0.05, 0.05), nullptr);
}

TEST(VolumeMapper, GoesOnWithItsStoreAfterTheProcessWasKilled) {
  const test::TemporaryDirectory folder;
  const std::string store = (folder.path() / "map.ot").string();
  const std::string parameters = "publish_period_s: 0, store_period_s: 0, store: '" + store + "'";
  const auto see_wall = [](Robot& robot, float x) {
    robot.move(1.0, 0.0);
    robot.move(2.0, 0.0);
    robot.see(1.5, wall(x));
  };
  {
    Robot killed(parameters);
    see_wall(killed, 2.1F);
    ASSERT_EQ(killed.wait_for(1).size(), 1U);
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!std::filesystem::exists(store) && std::chrono::steady_clock::now() < patience) {
      killed.tick();
    }
    // As it is on disk at a moment before the end.
    std::filesystem::copy_file(store, store + ".killed");
  }
  std::filesystem::rename(store + ".killed", store);
  Robot again(parameters);
  const auto maps = again.wait_for(1);
  ASSERT_EQ(maps.size(), 1U) << "told before the first cloud";
  EXPECT_TRUE(is_occupied(tree_of(maps[0]), 2.35, 0.05, 0.05));
  see_wall(again, -2.1F);
  const auto grown = again.wait_for(2);
  ASSERT_EQ(grown.size(), 2U);
  EXPECT_TRUE(is_occupied(tree_of(grown[1]), 2.35, 0.05, 0.05));
  EXPECT_TRUE(is_occupied(tree_of(grown[1]), -1.85, 0.05, 0.05));
}

TEST(VolumeMapper, IsDeactivatedOnAFullDiskAndWritesItsStoreWhenThereIsRoom) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path store = folder.path() / "map.ot";
  Robot robot("publish_period_s: 0, store_period_s: 3600, store: '" + store.string() +
              "', save: '" + (folder.path() / "map.bt").string() + "'");
  robot.move(1.0, 0.0);
  robot.move(2.0, 0.0);
  robot.see(1.5, wall(2.1F));
  ASSERT_EQ(robot.wait_for(1).size(), 1U);
  EXPECT_THAT(test::deactivate_on_a_full_disk(robot.host()),
              ElementsAre(HasSubstr("map.ot"), HasSubstr("map.bt")));
  EXPECT_TRUE(std::filesystem::exists(store));
}

TEST(VolumeMapper, RefusesAStoreOfOtherVoxelsAndLeavesItAlone) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path store = folder.path() / "map.ot";
  volume::VolumeConfig coarse;
  coarse.resolution_m = 0.5;
  std::ofstream(store, std::ios::trunc) << volume::VolumeMap(coarse).full_file();
  const auto written = std::filesystem::last_write_time(store);
  EXPECT_THROW(Robot("store: '" + store.string() + "'"), InputError);
  EXPECT_EQ(std::filesystem::last_write_time(store), written);
}

TEST(VolumeMapper, WaitsForTfAndIsUnharmedByCloudsThatMakeNoSense) {
  Robot robot("publish_period_s: 0, waiting_clouds: 3");
  PointCloud2 fieldless = convert::to_message(wall(1.0F), Stamp::from_seconds(1.5), "lidar");
  fieldless.fields().clear();
  robot.publish(fieldless);
  robot.see(1.5, wall(1.0F), "unknown_frame");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  auto points = wall(2.1F);
  points.insert(points.begin(), {nan, 0.0F, 0.0F});
  robot.see(1.5, points);
  robot.move(1.0, 0.0);
  robot.move(2.0, 1.0);
  const auto maps = robot.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  volume::VolumeMap expected(volume::VolumeConfig{});
  volume::Cloud cloud;
  cloud.map_from_sensor.translation.x() = 0.75;
  cloud.points_m = wall(2.1F);
  WorkerPool pool(1);
  expected.insert(cloud, {}, pool);
  const std::string data = expected.binary_message_data();
  EXPECT_EQ(maps[0].data(), std::vector<std::int8_t>(data.begin(), data.end()));
}

TEST(VolumeMapper, TakesPointsFromWhereEachWasMeasured) {
  Robot robot("publish_period_s: 0");
  robot.move(1.0, 0.0);
  // The second half is seen from 0.8 m further on; the cloud waits until tf has come that far.
  std::vector<Eigen::Vector3f> points = wall(2.1F);
  std::vector<float> offset_s(points.size(), 0.0F);
  for (const Eigen::Vector3f& p : wall(1.3F)) {
    points.push_back(p);
    offset_s.push_back(0.8F);
  }
  offset_s[0] = 1e18F;  // wild: as if it had none
  offset_s[1] = std::numeric_limits<float>::quiet_NaN();
  robot.see_over_time(1.0, points, offset_s);
  robot.move(1.5, 0.5);
  robot.move(2.0, 1.0);
  const auto maps = robot.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  const octomap::OcTree tree = tree_of(maps[0]);
  EXPECT_TRUE(is_occupied(tree, 2.35, 0.05, 0.05));
  EXPECT_FALSE(is_occupied(tree, 1.55, 0.05, 0.05));
}

TEST(VolumeMapper, LeavesOutPointsAboutDynamicBeamsAndSavesTheMap) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "map.bt";
  Robot robot("publish_period_s: 0, wait_for_labels: true, save: '" + file.string() + "'");
  robot.label_moving(1.5, 1.9);
  robot.move(1.0, 0.0);
  robot.move(2.0, 1.0);
  robot.see(1.5, wall(2.1F));
  const auto maps = robot.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  const octomap::OcTree tree = tree_of(maps[0]);
  EXPECT_FALSE(is_occupied(tree, 2.85, 0.05, 0.25));  // in the box about (2.8, 0)
  EXPECT_TRUE(is_occupied(tree, 2.85, 0.45, 0.25));   // beside it
  robot.deactivate();
  octomap::OcTree saved(1.0);
  ASSERT_TRUE(saved.readBinary(file.string()));
  EXPECT_EQ(saved.size(), tree.size());
}

}  // namespace
}  // namespace strata::volume_mapper
