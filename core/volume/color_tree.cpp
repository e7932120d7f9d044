// SPDX-License-Identifier: Apache-2.0
#include "core/volume/color_tree.hpp"

#include <sstream>
#include <utility>

#include <octomap/ColorOcTree.h>

#include "core/base/error.hpp"
#include "core/volume/color_map.hpp"
#include "core/volume/leaf_tree.hpp"
#include "core/volume/octomap_header.hpp"

namespace strata::volume {
namespace {

using octomap::ColorOcTreeNode;

using ColorTree = LeafTree<octomap::ColorOcTree, ColorOcTreeNode>;

void paint(ColorOcTreeNode& node, float log_odds, const Rgb& color) {
  node.setLogOdds(log_odds);
  node.setColor(color.r, color.g, color.b);
}

ColorTree tree_of(const VolumeMap& map, const ColorOf& color_of) {
  ColorTree tree(map.lattice().resolution_m());
  map.for_each_cube([&](const VoxelCube& cube) {
    if (cube.is_occupied) {
      for_each_voxel(cube, [&](const VoxelKey& key) {
        paint(tree.leaf(key, kLatticeDepth), cube.log_odds, color_of(key));
      });
      return;
    }
    unsigned depth = kLatticeDepth;
    for (std::int32_t edge = cube.edge; edge > 1; edge >>= 1) --depth;
    paint(tree.leaf(cube.corner, depth), cube.log_odds, {255, 255, 255});
  });
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

}  // namespace

std::string color_file(const VolumeMap& map, const ColorOf& color_of) {
  const ColorTree tree = tree_of(map, color_of);
  std::ostringstream out(std::ios::binary);
  out << octomap_header("# Octomap OcTree file", tree);
  tree.writeData(out);
  return std::move(out).str();
}

std::string color_message_data(const VolumeMap& map, const ColorOf& color_of) {
  std::ostringstream out(std::ios::binary);
  tree_of(map, color_of).writeData(out);
  return std::move(out).str();
}

void read_color_file(const std::string& bytes, const std::string& place, double resolution_m,
                     const std::function<void(const VoxelKey&, const Rgb&)>& visit) {
  const OctomapFile file = open_octomap_file(bytes, place, "ColorOcTree");
  if (file.is_binary || !is_same_edge(file.resolution_m, resolution_m)) {
    throw InputError(place, "its voxels have no colours or other edges", "name another file");
  }
  if (file.data.empty()) return;
  octomap::ColorOcTree tree(file.resolution_m);
  std::istringstream in(file.data, std::ios::binary);
  tree.readData(in);
  for (auto it = tree.begin_leafs(); it != tree.end_leafs(); ++it) {
    if (!tree.isNodeOccupied(*it)) continue;
    const std::int32_t edge = std::int32_t{1} << (kLatticeDepth - static_cast<int>(it.getDepth()));
    const octomap::OcTreeKey& key = it.getKey();
    const std::int32_t mask = ~(edge - 1);
    const VoxelCube cube{{key[0] & mask, key[1] & mask, key[2] & mask}, edge};
    const ColorOcTreeNode::Color& color = it->getColor();
    for_each_voxel(cube, [&](const VoxelKey& voxel) { visit(voxel, {color.r, color.g, color.b}); });
  }
}

std::string ColorMap::file(const VolumeMap& map) const {
  auto voxel = voxels_.begin();  // in the order of the map's
  return color_file(map, [&](const VoxelKey& key) {
    if (voxel == voxels_.end() || voxel->key != key) return kGrey;  // it came since
    return (voxel++)->color;
  });
}

}  // namespace strata::volume
