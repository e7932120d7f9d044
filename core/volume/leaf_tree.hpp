// SPDX-License-Identifier: Apache-2.0
/// Trees of OctoMap's made leaf by leaf.
#pragma once

#include <cstdint>

#include "core/volume/voxel.hpp"

namespace strata::volume {

/// Tree: one of octomap's.
template <typename Tree, typename Node>
class LeafTree final : public Tree {
 public:
  using Tree::Tree;

  /// A leaf of 2^(16 - depth) voxels an edge, made when missing; leaves must not overlap.
  Node& leaf(const VoxelKey& corner, unsigned depth) {
    if (this->root == nullptr) {
      this->root = new Node();
      ++this->tree_size;
    }
    Node* node = this->root;
    for (unsigned at = 0; at < depth; ++at) {
      const unsigned shift = static_cast<unsigned>(kLatticeDepth) - 1 - at;
      const auto bit = [shift](std::int32_t key) {
        return static_cast<unsigned>(key) >> shift & 1U;
      };
      const unsigned child = bit(corner.x) | bit(corner.y) << 1 | bit(corner.z) << 2;
      node = this->nodeChildExists(node, child) ? this->getNodeChild(node, child)
                                                : this->createNodeChild(node, child);
    }
    return *node;
  }
};

}  // namespace strata::volume
