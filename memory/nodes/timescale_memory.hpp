// SPDX-License-Identifier: Apache-2.0
/// The timescale memory: nodes along the robot's ways, each with levels that forget at different
/// speeds [kessler2010what].
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/levels/node_level.hpp"
#include "memory/levels/virtual_scan.hpp"
#include "memory/nodes/node_map.hpp"
#include "memory/nodes/timescale_config.hpp"

namespace strata::memory {

/// A place with its levels, in the order of the configuration.
struct MemoryNode {
  Eigen::Vector2d position_m;
  std::vector<NodeLevel> levels;
  std::uint64_t observations = 0;  ///< scans that passed the gate
  // What the gate compares with: the last scan taken.
  int last_run = 0;
  Stamp last_stamp;
  Pose2 last_pose;
};

/// What became of a scan.
enum class ObserveOutcome {
  kTaken,      ///< offered to the levels of `node`
  kTooSoon,    ///< the node took one a moment ago
  kFarAway,    ///< no node near enough, and none needed
  kUncertain,  ///< the pose is not certain enough
  kUnseen,     ///< the node does not lie in what the scan saw
};
struct Observed {
  ObserveOutcome outcome = ObserveOutcome::kFarAway;
  int node = -1;
  bool is_new_node = false;
};

/// State and update. The same seed and the same scans in the same order give the same bytes. One
/// thread at a time.
class TimescaleMemory {
 public:
  /// Throws ConfigError.
  explicit TimescaleMemory(TimescaleConfig config = {}, std::uint64_t seed = 1);
  TimescaleMemory(TimescaleMemory&&) noexcept = default;
  TimescaleMemory& operator=(TimescaleMemory&&) noexcept = default;

  [[nodiscard]] const TimescaleConfig& config() const { return config_; }
  [[nodiscard]] const std::vector<MemoryNode>& nodes() const { return nodes_; }
  /// Scans taken by all nodes together.
  [[nodiscard]] std::uint64_t observations() const { return observations_; }

  /// One scan updates at most one node. covariance: of map_from_robot as (x, y, theta) in the map
  /// frame; null when the pose is known. O(nodes + beams + levels x angle bins).
  Observed observe(const PosedScan& scan, const Eigen::Matrix3d* covariance = nullptr);

  /// What every level of every node expects, as an immutable snapshot. Levels that have not changed
  /// since `previous` (a snapshot of this memory with the same configuration) are not decoded
  /// again.
  [[nodiscard]] std::shared_ptr<const NodeMap> decode(const DecodingConfig& decoding = {},
                                                      const NodeMap* previous = nullptr) const;

  /// Size of the whole state, as stored before compression.
  [[nodiscard]] std::size_t bytes() const;
  /// The whole state; two memories are equal when these are.
  [[nodiscard]] std::vector<std::byte> state() const;

  /// The state in parts, for the store.
  struct NodeState {
    std::vector<std::byte> head;
    std::vector<std::vector<std::byte>> levels;
  };
  [[nodiscard]] std::vector<std::byte> head_state() const;
  [[nodiscard]] NodeState node_state(std::size_t node) const;
  /// Throws InputError{place} when the parts do not fit together.
  [[nodiscard]] static TimescaleMemory restore(std::span<const std::byte> head,
                                               std::span<const NodeState> nodes,
                                               const std::string& place);

 private:
  [[nodiscard]] int nearest_node(const Eigen::Vector2d& point_m, double& distance_m) const;
  int add_node(const Eigen::Vector2d& position_m);
  [[nodiscard]] double insertion_probability(const MemoryNode& node, std::size_t level) const;
  [[nodiscard]] bool is_due(const MemoryNode& node, const PosedScan& scan) const;
  [[nodiscard]] bool is_certain(const Eigen::Matrix3d& covariance) const;

  TimescaleConfig config_;
  std::uint64_t seed_;
  std::uint64_t observations_ = 0;
  std::vector<double> insertion_probability_;  ///< per level, after warming up
  std::vector<MemoryNode> nodes_;
  VirtualScanner scanner_;
  VirtualScan virtual_scan_;
};

}  // namespace strata::memory
