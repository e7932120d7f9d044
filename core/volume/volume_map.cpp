// SPDX-License-Identifier: Apache-2.0
#include "core/volume/volume_map.hpp"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include <octomap/OcTree.h>

#include "core/base/damage.hpp"
#include "core/volume/octomap_header.hpp"

namespace strata::volume {
namespace {

/// One brick of marks and where it belongs among an octree's leaves.
struct BrickUpdate {
  std::uint64_t order = 0;
  const BrickMarks* marks = nullptr;
};

/// Depth of the nodes that hold one brick.
constexpr unsigned kBrickDepth = kLatticeDepth - 3;

/// OctoMap's tree, updated by whole clouds: one walk over the nodes that change instead of one from
/// the root to each voxel.
class Tree final : public octomap::OcTree {
 public:
  using Node = octomap::OcTreeNode;
  using octomap::OcTree::OcTree;

  void apply(std::span<const BrickUpdate> updates) {
    if (updates.empty()) return;
    const bool is_new = root == nullptr;
    if (is_new) {
      root = new Node();
      ++tree_size;
    }
    apply_above(root, is_new, 0, updates);
  }

 private:
  /// Nodes that hold several bricks.
  void apply_above(Node* node, bool is_new, unsigned depth, std::span<const BrickUpdate> updates) {
    if (!is_new && !has_children(node) && leaves_alone(node->getValue(), updates)) return;
    if (depth == kBrickDepth) {
      apply_brick(node, is_new, *updates.front().marks);
      return;
    }
    const unsigned shift = 3 * (kBrickDepth - 1 - depth);
    for (std::size_t begin = 0; begin < updates.size();) {
      const auto child = static_cast<unsigned>(updates[begin].order >> shift & 7U);
      std::size_t end = begin + 1;
      while (end < updates.size() && (updates[end].order >> shift & 7U) == child) ++end;
      const auto [next, is_next_new] = child_of(node, is_new, child);
      apply_above(next, is_next_new, depth + 1, updates.subspan(begin, end - begin));
      begin = end;
    }
    settle(node);
  }

  void apply_brick(Node* node, bool is_new, const BrickMarks& marks) {
    for (unsigned i = 0; i < 8; ++i) {
      const std::uint64_t passed = marks.passed[i];
      const std::uint64_t ended = marks.ended[i];
      if ((passed | ended) == 0) continue;
      const auto [next, is_next_new] = child_of(node, is_new, i);
      apply_below<64>(next, is_next_new, passed, ended);
    }
    settle(node);
  }

  /// A cube of kVoxels voxels; bits above are 0.
  template <unsigned kVoxels>
  void apply_below(Node* node, bool is_new, std::uint64_t passed, std::uint64_t ended) {
    constexpr std::uint64_t kAll =
        kVoxels == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << (kVoxels % 64)) - 1;
    if (is_new || !has_children(node)) {
      // All voxels are alike: one node says it, as pruning would in the end.
      const bool is_leaf = kVoxels == 1 || !is_new;
      const float value = node->getValue();
      const bool is_settled = is_leaf && ((ended == 0 && value <= clamping_thres_min) ||
                                          (passed == 0 && value >= clamping_thres_max));
      if (is_settled) return;
      if (passed == kAll) return add(node, prob_miss_log);
      if (ended == kAll) return add(node, prob_hit_log);
    }
    if constexpr (kVoxels > 1) {
      constexpr unsigned kPart = kVoxels / 8;
      constexpr std::uint64_t kPartMask = (std::uint64_t{1} << kPart) - 1;
      for (unsigned i = 0; i < 8; ++i) {
        const std::uint64_t part_passed = passed >> (i * kPart) & kPartMask;
        const std::uint64_t part_ended = ended >> (i * kPart) & kPartMask;
        if ((part_passed | part_ended) == 0) continue;
        const auto [next, is_next_new] = child_of(node, is_new, i);
        apply_below<kPart>(next, is_next_new, part_passed, part_ended);
      }
      settle(node);
    }
  }

  /// Whether a value is at the limit that all updates push it to.
  bool leaves_alone(float value, std::span<const BrickUpdate> updates) const {
    const bool is_least = value <= clamping_thres_min;
    if (!is_least && value < clamping_thres_max) return false;
    return std::all_of(updates.begin(), updates.end(), [&](const BrickUpdate& update) {
      const auto& others = is_least ? update.marks->ended : update.marks->passed;
      return std::all_of(others.begin(), others.end(), [](std::uint64_t w) { return w == 0; });
    });
  }

  bool has_children(const Node* node) const { return octomap::OcTree::nodeHasChildren(node); }

  /// The child, made when missing: alone below a new node, with its seven like siblings below a
  /// pruned one.
  std::pair<Node*, bool> child_of(Node* node, bool is_new, unsigned i) {
    if (octomap::OcTree::nodeChildExists(node, i)) {
      return {octomap::OcTree::getNodeChild(node, i), false};
    }
    if (!is_new && !has_children(node)) {
      octomap::OcTree::expandNode(node);
      return {octomap::OcTree::getNodeChild(node, i), false};
    }
    return {octomap::OcTree::createNodeChild(node, i), true};
  }

  void add(Node* node, float log_odds) const {
    node->setValue(
        std::min(std::max(node->getValue() + log_odds, clamping_thres_min), clamping_thres_max));
  }

  void settle(Node* node) {
    if (!octomap::OcTree::pruneNode(node)) node->updateOccupancyChildren();
  }
};

/// Occupied or free for sure, alike cubes as one.
octomap::OcTree likely_tree(const octomap::OcTree& tree) {
  octomap::OcTree likely(tree);
  likely.toMaxLikelihood();
  likely.prune();
  return likely;
}

}  // namespace

struct VolumeMap::State {
  explicit State(const VolumeConfig& given)
      : config(given), lattice(given.resolution_m), tree(given.resolution_m) {
    tree.setProbHit(config.probability_hit);
    tree.setProbMiss(config.probability_miss);
    tree.setClampingThresMin(config.min_probability);
    tree.setClampingThresMax(config.max_probability);
    limits = ray_limits(config);
  }
  VolumeConfig config;
  VoxelLattice lattice;
  RayLimits limits;
  Tree tree;
  CloudMarks marks;
  CloudInMap in_map;
  std::vector<BrickUpdate> updates;
};

VolumeMap::VolumeMap(const VolumeConfig& config) {
  require_valid(config, "volume");
  state_ = std::make_unique<State>(config);
}
VolumeMap::~VolumeMap() = default;
VolumeMap::VolumeMap(VolumeMap&&) noexcept = default;
VolumeMap& VolumeMap::operator=(VolumeMap&&) noexcept = default;

const VolumeConfig& VolumeMap::config() const { return state_->config; }
const VoxelLattice& VolumeMap::lattice() const { return state_->lattice; }

CloudCounts VolumeMap::insert(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                              WorkerPool& pool) {
  State& s = *state_;
  bring_into_map(cloud, pool, s.in_map);
  const CloudCounts counts =
      s.marks.mark(s.in_map.origins, s.in_map.ends_m, is_dynamic, s.lattice, s.limits, pool);
  const BrickMap<BrickMarks>& bricks = s.marks.bricks();
  s.updates.resize(bricks.size());
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    s.updates[i] = {brick_order(bricks.ids()[i]), &bricks.value(i)};
  }
  std::sort(s.updates.begin(), s.updates.end(),
            [](const BrickUpdate& a, const BrickUpdate& b) { return a.order < b.order; });
  s.tree.apply(s.updates);
  return counts;
}

std::optional<float> VolumeMap::log_odds(const Eigen::Vector3d& point_m) const {
  const octomap::OcTreeNode* node = state_->tree.search(point_m.x(), point_m.y(), point_m.z());
  if (node == nullptr) return std::nullopt;
  return node->getLogOdds();
}

bool VolumeMap::is_occupied(float log_odds) const {
  return log_odds >= state_->tree.getOccupancyThresLog();
}

VolumeSize VolumeMap::size() const {
  const Tree& tree = state_->tree;
  return {tree.size(), tree.getNumLeafNodes(), tree.memoryUsage()};
}

void VolumeMap::for_each_cube(const std::function<void(const VoxelCube&)>& visit) const {
  const Tree& tree = state_->tree;
  for (auto it = tree.begin_leafs(); it != tree.end_leafs(); ++it) {
    const std::int32_t edge = std::int32_t{1} << (kLatticeDepth - static_cast<int>(it.getDepth()));
    const octomap::OcTreeKey& key = it.getKey();
    // OctoMap names a cube by its middle voxel.
    const std::int32_t mask = ~(edge - 1);
    visit({{key[0] & mask, key[1] & mask, key[2] & mask},
           edge,
           it->getLogOdds(),
           tree.isNodeOccupied(*it)});
  }
}

std::string VolumeMap::binary_file() const {
  const octomap::OcTree likely = likely_tree(state_->tree);
  std::ostringstream out(std::ios::binary);
  out << octomap_header("# Octomap OcTree binary file", likely);
  likely.writeBinaryData(out);
  return std::move(out).str();
}

VolumeMap VolumeMap::from_file(const std::string& bytes, const std::string& place,
                               const std::optional<VolumeConfig>& wanted) {
  const OctomapFile file = open_octomap_file(bytes, place, "OcTree");
  VolumeConfig config = wanted.value_or(VolumeConfig{});
  if (wanted && !is_same_edge(file.resolution_m, wanted->resolution_m)) {
    throw InputError(place, "its voxels have edges of " + std::to_string(file.resolution_m) + " m",
                     "set resolution_m to that, or name another file");
  }
  if (!wanted) config.resolution_m = file.resolution_m;
  VolumeMap map(config);
  if (file.data.empty()) return map;
  std::istringstream in(file.data, std::ios::binary);
  if (file.is_binary) {
    map.state_->tree.readBinaryData(in);
  } else {
    map.state_->tree.readData(in);
  }
  if (!in) throw DamageError(place, "cannot be read to its end", "give another file");
  return map;
}

std::string VolumeMap::full_file() const {
  std::ostringstream out(std::ios::binary);
  out << octomap_header("# Octomap OcTree file", state_->tree);
  state_->tree.writeData(out);
  return std::move(out).str();
}

std::string VolumeMap::binary_message_data() const {
  std::ostringstream out(std::ios::binary);
  likely_tree(state_->tree).writeBinaryData(out);
  return std::move(out).str();
}

}  // namespace strata::volume
