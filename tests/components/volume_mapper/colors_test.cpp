// SPDX-License-Identifier: Apache-2.0
/// Colours of clouds in the live map.
#include <chrono>
#include <filesystem>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>

#include "tests/components/volume_mapper/robot.hpp"
#include "tests/support/test_data.hpp"

namespace strata::volume_mapper {
namespace {

octomap::ColorOcTree color_tree_of(const Octomap& message) {
  octomap::ColorOcTree tree(message.resolution());
  std::istringstream data(std::string(message.data().begin(), message.data().end()));
  tree.readData(data);
  return tree;
}

using Color = octomap::ColorOcTreeNode::Color;

Color color_at(const octomap::ColorOcTree& tree, double x, double y, double z) {
  const octomap::ColorOcTreeNode* node = tree.search(x, y, z);
  return node == nullptr ? Color(1, 2, 3) : node->getColor();
}

TEST(VolumeMapper, GivesVoxelsTheColoursOfThePointsInThem) {
  Robot robot("publish_period_s: 0");
  robot.move(1.0, 0.0);
  robot.move(2.0, 0.0);
  robot.see_colored(1.5, wall(2.1F), 0xFF8000);
  ASSERT_EQ(robot.tick_for_colored(1).size(), 1U);
  robot.see(1.6, wall(-2.1F));  // a cloud without colours
  ASSERT_EQ(robot.tick_for_colored(2).size(), 2U);
  robot.see_colored(1.7, wall(2.1F), 0x008040);
  const auto maps = robot.tick_for_colored(3);
  ASSERT_EQ(maps.size(), 3U);
  EXPECT_EQ(maps[2].header().frame_id(), "map");
  EXPECT_FALSE(maps[2].binary());
  EXPECT_EQ(maps[2].id(), "ColorOcTree");
  EXPECT_EQ(color_at(color_tree_of(maps[0]), 2.35, 0.05, 0.05), Color(255, 128, 0));
  const octomap::ColorOcTree tree = color_tree_of(maps[2]);
  EXPECT_EQ(color_at(tree, 2.35, 0.05, 0.05), Color(128, 128, 32)) << "the mean of two clouds";
  EXPECT_EQ(color_at(tree, -1.85, 0.05, 0.05), Color(128, 128, 128)) << "nobody told";
  const octomap::ColorOcTreeNode* node = tree.search(2.35, 0.05, 0.05);
  ASSERT_NE(node, nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(node));
  EXPECT_FALSE(tree.isNodeOccupied(tree.search(1.3, 0.05, 0.05))) << "free space is kept";
}

TEST(VolumeMapper, GivesNoColouredMapOfCloudsWithoutColoursOrWhenNotAsked) {
  const auto colored_after = [](const std::string& parameters, bool in_color) {
    Robot robot("publish_period_s: 0" + parameters);
    robot.move(1.0, 0.0);
    robot.move(2.0, 0.0);
    if (in_color) robot.see_colored(1.5, wall(2.1F), 0x00FF00);
    if (!in_color) robot.see(1.5, wall(2.1F));
    EXPECT_EQ(robot.wait_for(1).size(), 1U);
    return robot.wait_for_colored(1, std::chrono::milliseconds(300)).size();
  };
  EXPECT_EQ(colored_after("", true), 1U);
  EXPECT_EQ(colored_after("", false), 0U);
  EXPECT_EQ(colored_after(", has_colors: false", true), 0U);
}

TEST(VolumeMapper, ColoursALateCloudWhenTfComesAndLeavesOutWhatMoves) {
  Robot robot("publish_period_s: 0, wait_for_labels: true");
  robot.label_moving(1.5, 1.9);
  robot.see_colored(1.5, wall(2.1F), 0x0000FF);
  robot.see_colored(1.5, wall(2.1F), 0x0000FF);  // told twice
  robot.move(1.0, 0.0);
  robot.move(2.0, 1.0);
  const auto maps = robot.tick_for_colored(2);
  ASSERT_EQ(maps.size(), 2U);
  const octomap::ColorOcTree tree = color_tree_of(maps[1]);
  EXPECT_EQ(color_at(tree, 2.85, 0.45, 0.25), Color(0, 0, 255)) << "beside the box";
  const octomap::ColorOcTreeNode* inside = tree.search(2.85, 0.05, 0.25);
  EXPECT_TRUE(inside == nullptr || !tree.isNodeOccupied(inside));
}

TEST(VolumeMapper, KeepsColoursBesideItsStoreAndDoesWithoutDamagedOnes) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path store = folder.path() / "map.ot";
  const std::filesystem::path colors = folder.path() / "map_color.ot";
  const std::string parameters = "publish_period_s: 0, store: '" + store.string() + "'";
  {
    Robot robot(parameters);
    robot.move(1.0, 0.0);
    robot.move(2.0, 0.0);
    robot.see_colored(1.5, wall(2.1F), 0x203040);
    ASSERT_EQ(robot.wait_for_colored(1).size(), 1U);
    robot.deactivate();
  }
  ASSERT_TRUE(std::filesystem::exists(colors));
  {
    Robot again(parameters);
    const auto maps = again.wait_for_colored(1);
    ASSERT_EQ(maps.size(), 1U) << "told before the first cloud";
    EXPECT_EQ(color_at(color_tree_of(maps[0]), 2.35, 0.05, 0.05), Color(0x20, 0x30, 0x40));
  }
  std::filesystem::resize_file(colors, std::filesystem::file_size(colors) / 2);
  Robot damaged(parameters);
  const auto maps = damaged.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_TRUE(is_occupied(tree_of(maps[0]), 2.35, 0.05, 0.05)) << "the map is sound";
  EXPECT_TRUE(damaged.wait_for_colored(1, std::chrono::milliseconds(300)).empty());
  EXPECT_FALSE(std::filesystem::exists(colors)) << "set aside";
}

}  // namespace
}  // namespace strata::volume_mapper
