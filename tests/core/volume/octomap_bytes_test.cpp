// SPDX-License-Identifier: Apache-2.0
#include "core/volume/octomap_bytes.hpp"

#include <cstddef>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/volume/volume_map.hpp"
#include "tests/core/volume/random_clouds.hpp"

namespace strata::volume {
namespace {

using namespace std::string_literals;

// A value of four bytes, then one bit a child.
const std::string kLeaf = "\0\0\0\0\x00"s;
const std::string kOneChild = "\0\0\0\0\x01"s;
const std::string kTwoChildren = "\0\0\0\0\x81"s;

TEST(OctomapNodes, CountsNodesOfFullTrees) {
  EXPECT_EQ(octomap_nodes(kLeaf, NodeForm::kFull), 1);
  EXPECT_EQ(octomap_nodes(kTwoChildren + kLeaf + kOneChild + kLeaf, NodeForm::kFull), 4);
  EXPECT_EQ(octomap_nodes(kLeaf + "more", NodeForm::kFull), 1) << "what follows is not its own";
}

TEST(OctomapNodes, CountsNodesOfBinaryTreesWhoseLeavesTakeNoBytes) {
  EXPECT_EQ(octomap_nodes("\0\0"s, NodeForm::kBinary), 1);
  // A free child, an occupied one, and one that has two children of its own.
  EXPECT_EQ(octomap_nodes("\x39\0\x09\0"s, NodeForm::kBinary), 6);
}

TEST(OctomapNodes, CountsNodesOfColoredTrees) {
  const std::string leaf = "\0\0\0\0rgb\0"s;
  const std::string tree = "\0\0\0\0rgb\x11"s + leaf + leaf;
  EXPECT_EQ(octomap_nodes(tree, NodeForm::kColor), 3);
  for (std::size_t i = 0; i < tree.size(); ++i) {
    EXPECT_FALSE(octomap_nodes(std::string_view(tree).substr(0, i), NodeForm::kColor)) << i;
  }
}

TEST(OctomapNodes, GivesNothingForTreesThatEndTooEarly) {
  const std::string full = kTwoChildren + kLeaf + kOneChild + kLeaf;
  const std::string binary = "\x39\0\x09\0"s;
  for (std::size_t i = 0; i < full.size(); ++i) {
    EXPECT_FALSE(octomap_nodes(std::string_view(full).substr(0, i), NodeForm::kFull)) << i;
  }
  for (std::size_t i = 0; i < binary.size(); ++i) {
    EXPECT_FALSE(octomap_nodes(std::string_view(binary).substr(0, i), NodeForm::kBinary)) << i;
  }
}

TEST(OctomapNodes, GivesNothingForTreesDeeperThanSixteenLevels) {
  const auto chain = [](std::size_t inner) {
    std::string bytes;
    for (std::size_t i = 0; i < inner; ++i) bytes += kOneChild;
    return bytes + kLeaf;
  };
  EXPECT_EQ(octomap_nodes(chain(16), NodeForm::kFull), 17);
  EXPECT_FALSE(octomap_nodes(chain(17), NodeForm::kFull));
}

TEST(OctomapNodes, CountsAsManyAsTheTreeHasAndFilesThatDoNotAreRefused) {
  WorkerPool pool(1);
  VolumeMap map(VolumeConfig{});
  for (std::size_t i = 0; i < 3; ++i) map.insert(test_clouds::room_cloud(5, i, 500), {}, pool);
  for (const std::string& whole : {map.full_file(), map.binary_file()}) {
    const std::size_t data = whole.find("\ndata\n") + 6;
    const auto form = whole.find("binary") < data ? NodeForm::kBinary : NodeForm::kFull;
    EXPECT_THROW((void)VolumeMap::from_file(whole.substr(0, data - 1), "header"), InputError);
    const auto nodes = octomap_nodes(std::string_view(whole).substr(data), form);
    EXPECT_EQ(nodes, VolumeMap::from_file(whole, "whole").size().nodes);
    for (std::size_t length = data; length < whole.size(); length += 1 + whole.size() / 97) {
      EXPECT_THROW((void)VolumeMap::from_file(whole.substr(0, length), "cut"), InputError)
          << length;
    }
    // Every node has all eight children, and so on: far deeper than any tree.
    const std::string deep = whole.substr(0, data) + std::string(whole.size() - data, '\xff');
    EXPECT_THROW((void)VolumeMap::from_file(deep, "deep"), InputError);
    // A tree of its own that says another size.
    const std::size_t size = whole.find("\nsize ") + 6;
    EXPECT_THROW((void)VolumeMap::from_file(std::string(whole).insert(size, "1"), "size"),
                 InputError);
  }
}

}  // namespace
}  // namespace strata::volume
