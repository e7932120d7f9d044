// SPDX-License-Identifier: Apache-2.0
#include "core/volume/level_tree.hpp"

#include <sstream>
#include <utility>

#include <octomap/OcTree.h>

#include "core/volume/leaf_tree.hpp"
#include "core/volume/octomap_header.hpp"

namespace strata::volume {
namespace {

using LevelTree = LeafTree<octomap::OcTree, octomap::OcTreeNode>;

LevelTree tree_of(const VoxelMemory& memory, VoxelLevel level) {
  LevelTree tree(memory.lattice().resolution_m());
  const float free = tree.getClampingThresMinLog();
  const float occupied = tree.getClampingThresMaxLog();
  memory.for_each_voxel(level, [&](const VoxelKey& key, double share) {
    tree.leaf(key, kLatticeDepth).setLogOdds(share >= 0.5 ? occupied : free);
  });
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

}  // namespace

std::string level_file(const VoxelMemory& memory, VoxelLevel level) {
  const LevelTree tree = tree_of(memory, level);
  std::ostringstream out(std::ios::binary);
  out << octomap_header("# Octomap OcTree binary file", tree);
  tree.writeBinaryData(out);
  return std::move(out).str();
}

std::string level_message_data(const VoxelMemory& memory, VoxelLevel level) {
  std::ostringstream out(std::ios::binary);
  tree_of(memory, level).writeBinaryData(out);
  return std::move(out).str();
}

}  // namespace strata::volume
