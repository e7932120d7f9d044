// SPDX-License-Identifier: Apache-2.0
/// Coloured maps as OctoMap keeps them.
#include <sstream>
#include <utility>

#include <octomap/ColorOcTree.h>

#include "core/volume/color_map.hpp"
#include "core/volume/octomap_header.hpp"

namespace strata::volume {
namespace {

using octomap::ColorOcTreeNode;

class ColorTree final : public octomap::ColorOcTree {
 public:
  using octomap::ColorOcTree::ColorOcTree;

  /// A leaf of 2^(16 - depth) voxels an edge; leaves must not overlap.
  void add_leaf(const VoxelKey& corner, unsigned depth, float log_odds, const Rgb& color) {
    if (root == nullptr) {
      root = new ColorOcTreeNode();
      ++tree_size;
    }
    ColorOcTreeNode* node = root;
    for (unsigned at = 0; at < depth; ++at) {
      const unsigned shift = static_cast<unsigned>(kLatticeDepth) - 1 - at;
      const auto bit = [shift](std::int32_t key) {
        return static_cast<unsigned>(key) >> shift & 1U;
      };
      const unsigned child = bit(corner.x) | bit(corner.y) << 1 | bit(corner.z) << 2;
      node =
          nodeChildExists(node, child) ? getNodeChild(node, child) : createNodeChild(node, child);
    }
    node->setLogOdds(log_odds);
    node->setColor(color.r, color.g, color.b);
  }
};

}  // namespace

std::string ColorMap::file(const VolumeMap& map) const {
  ColorTree tree(lattice_.resolution_m());
  map.for_each_cube([&](const VoxelCube& cube) {
    if (cube.is_occupied) return;
    unsigned depth = kLatticeDepth;
    for (std::int32_t edge = cube.edge; edge > 1; edge >>= 1) --depth;
    tree.add_leaf(cube.corner, depth, cube.log_odds, {255, 255, 255});
  });
  for (const ColoredVoxel& voxel : voxels_) {
    tree.add_leaf(voxel.key, kLatticeDepth, voxel.log_odds, voxel.color);
  }
  tree.updateInnerOccupancy();
  tree.prune();
  std::ostringstream out(std::ios::binary);
  out << octomap_header("# Octomap OcTree file", tree);
  tree.writeData(out);
  return std::move(out).str();
}

}  // namespace strata::volume
