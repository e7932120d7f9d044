// SPDX-License-Identifier: Apache-2.0
/// The timescale memory: nodes along the robot's ways, each with levels that forget at different
/// speeds [kessler2010what].
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/base/damage.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/scanner_turns.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/levels/node_level.hpp"
#include "memory/levels/virtual_scan.hpp"
#include "memory/nodes/day_batch.hpp"
#include "memory/nodes/node_map.hpp"
#include "memory/nodes/node_source.hpp"
#include "memory/nodes/timescale_config.hpp"

namespace strata::memory {

/// A place with its levels, in the order of the configuration.
struct MemoryNode {
  Eigen::Vector2d position_m;
  /// Empty while the node is evicted: only what follows below `today` is in memory then.
  std::vector<NodeLevel> levels;
  std::optional<DayBatch> today;   ///< when a level learns by days
  std::uint64_t observations = 0;  ///< scans that passed the gate
  // What the gate compares with: the last scan taken.
  int last_run = 0;
  int last_robot = 0;
  Stamp last_stamp;
  Pose2 last_pose;
  std::uint64_t last_used = 0;  ///< observations of the whole memory when it was last needed
  /// revisions() when it was last read from where it lies or evicted; empty: never.
  std::vector<std::uint64_t> stored_revisions;
  /// It lies where it cannot be read from any more; then it is evicted for good.
  bool is_damaged = false;

  [[nodiscard]] bool is_evicted() const { return levels.empty(); }
  /// Numbers that change with the content: observations, insertions of each level, and the day's.
  /// Requires that it is not evicted.
  [[nodiscard]] std::vector<std::uint64_t> revisions() const;
};

/// What became of a scan.
enum class ObserveOutcome {
  kTaken,      ///< offered to the levels of `node`
  kTooSoon,    ///< the node took one a moment ago
  kFarAway,    ///< the nearest node is beyond update_radius_m, but within node_spacing_m
  kUncertain,  ///< the pose is not certain enough
  kUnseen,     ///< no node nearby lies in what the scan saw, and they are too near for another
};
struct Observed {
  ObserveOutcome outcome = ObserveOutcome::kFarAway;
  int node = -1;
  bool is_new_node = false;
};

/// A node that `decode` passed over, and why.
struct DamagedNode {
  std::size_t node = 0;
  DamageError error;
};

/// State and update. The same seed and the same scans in the same order give the same bytes. One
/// thread at a time.
class TimescaleMemory {
 public:
  /// Throws ConfigError.
  explicit TimescaleMemory(TimescaleConfig config = {}, std::uint64_t seed = 1);
  [[nodiscard]] const TimescaleConfig& config() const { return config_; }
  [[nodiscard]] const std::vector<MemoryNode>& nodes() const { return nodes_; }
  /// Scans taken by all nodes together.
  [[nodiscard]] std::uint64_t observations() const { return observations_; }

  /// One scan updates at most one node: the nearest to the laser, within update_radius_m, that lies
  /// in what the scan saw. Where there is none, the laser's place becomes a node, unless another is
  /// within half of node_spacing_m. covariance: of map_from_robot as (x, y, theta) in the map
  /// frame; null when the pose is known. robot: who took it, from 0, where several feed one memory
  /// in whatever order; their scans then have one clock and one run. A node between two robots
  /// takes a scan of the other when its period is over: it forgets as if one robot were there. An
  /// evicted node is loaded first: throws InputError, and has not learned, when that fails; by a
  /// DamageError the node is passed over from then on. O(nodes + beams + levels x angle bins).
  Observed observe(const PosedScan& scan, const Eigen::Matrix3d* covariance = nullptr,
                   int robot = 0);

  /// The node was found to be damaged: scans make another where it is, and `decode` leaves it out.
  void pass_over(std::size_t node) { nodes_[node].is_damaged = true; }

  /// The day is over: levels that learn by days take in what they gathered. Happens by itself when
  /// a node sees a scan of a later day or run; call it after the last.
  void close_day();

  /// What every level of every node expects, as an immutable snapshot. Levels that have not changed
  /// since `previous` (a snapshot of this memory with the same configuration) are not decoded
  /// again. With `unsettled_s`, nodes that took a scan of the newest scan's run less than this
  /// before it stay as they were: a robot must not localize by what it has learned a moment ago.
  /// Evicted nodes that `previous` lacks are read, decoded and forgotten again, at most
  /// `max_loaded` of them, those nearest to the place of the last scan; the others are pending and
  /// expect nothing until a later snapshot has them. So do those that are damaged, which go to the
  /// end of `damaged`; without it the first of them is thrown.
  [[nodiscard]] std::shared_ptr<const NodeMap> decode(
      const DecodingConfig& decoding = {}, const NodeMap* previous = nullptr,
      double unsettled_s = 0.0, std::size_t max_loaded = std::numeric_limits<std::size_t>::max(),
      std::vector<DamagedNode>* damaged = nullptr) const;

  /// Nodes whose levels are in memory.
  [[nodiscard]] std::size_t resident() const;
  /// Evicts the nodes that were needed longest ago until at most `max_resident` are in memory.
  /// `source` must hold what they are at this moment. They are loaded when a scan is for them.
  /// O(nodes).
  void evict(std::size_t max_resident, std::shared_ptr<const NodeSource> source);

  /// Size of the whole state, as stored before compression; of evicted nodes only what is in
  /// memory.
  [[nodiscard]] std::size_t bytes() const;
  /// The whole state; two memories are equal when these are.
  [[nodiscard]] std::vector<std::byte> state() const;

  /// The state in parts, for the store.
  struct NodeState {
    std::vector<std::byte> head;
    /// One a level, and one more for the day when a level learns by days.
    std::vector<std::vector<std::byte>> levels;
  };
  [[nodiscard]] std::vector<std::byte> head_state() const;
  [[nodiscard]] NodeState node_state(std::size_t node) const;
  /// Whose turn it is at the gate, which the parts do not tell: for who goes on within a run.
  [[nodiscard]] const ScannerTurns& turns() const { return turns_; }
  void set_turns(ScannerTurns turns) { turns_ = std::move(turns); }
  /// An evicted node as it would be when loaded. Throws InputError when it cannot be read, and of
  /// those DamageError, with its place in the map, when it is damaged.
  [[nodiscard]] MemoryNode loaded(std::size_t node) const;
  /// Throws InputError{place} when the parts do not fit together.
  [[nodiscard]] static TimescaleMemory restore(std::span<const std::byte> head,
                                               std::span<const NodeState> nodes,
                                               const std::string& place);
  /// The same with all nodes evicted: of each only its head is read. O(nodes).
  [[nodiscard]] static TimescaleMemory restore_evicted(
      std::span<const std::byte> head, std::span<const std::vector<std::byte>> node_heads,
      std::shared_ptr<const NodeSource> source);

 private:
  /// Fills near_: distance and index of the nodes within node_spacing_m, nearest first, without
  /// those that are damaged.
  void find_near(const Eigen::Vector2d& point_m);
  /// The node for a scan, made if need be; when it is kTaken, virtual_scan_ is the node's.
  Observed choose_node(const PosedScan& scan, int robot);
  int add_node(const Eigen::Vector2d& position_m);
  /// Empty levels, and the day's when one learns by days.
  void allocate(MemoryNode& node) const;
  /// Requires a node that was just allocated.
  void read_levels(MemoryNode& node, std::span<const std::vector<std::byte>> levels,
                   const std::string& place) const;
  void load(int index);
  /// Which evicted nodes `decode` may read: nearest to the last scan's node first.
  [[nodiscard]] std::vector<bool> to_read(const NodeMap* previous, std::size_t most) const;
  struct DecodeRules {
    const DecodingConfig& decoding;
    double unsettled_s = 0.0;
    std::shared_ptr<const NodeMap::Level> nothing;
    std::vector<DamagedNode>* damaged = nullptr;
  };
  /// Of a node that `decode` needs; nothing for one that is passed over.
  [[nodiscard]] std::optional<MemoryNode> read_for(const DecodeRules& rules,
                                                   std::size_t index) const;
  [[nodiscard]] NodeMap::Node decode_node(std::size_t index, const NodeMap::Node* old,
                                          const DecodeRules& rules, bool may_read) const;
  void insert(MemoryNode& node, int index, const PosedScan& scan);
  void absorb_day(MemoryNode& node, int index);
  [[nodiscard]] double insertion_probability(const MemoryNode& node, std::size_t level) const;
  [[nodiscard]] bool is_due(const MemoryNode& node, const PosedScan& scan, int robot) const;
  [[nodiscard]] bool is_settled(const MemoryNode& node, double unsettled_s) const;
  [[nodiscard]] bool is_certain(const Eigen::Matrix3d& covariance) const;

  TimescaleConfig config_;
  std::uint64_t seed_;
  std::uint64_t observations_ = 0;
  int newest_run_ = 0;
  Stamp newest_stamp_;
  std::size_t newest_node_ = 0;
  std::shared_ptr<const NodeSource> source_;   ///< of the evicted nodes
  std::vector<double> insertion_probability_;  ///< per level, after warming up
  std::vector<MemoryNode> nodes_;
  ScannerTurns turns_;  ///< of several scanners at the gate of the nodes
  VirtualScanner scanner_;
  VirtualScan virtual_scan_;
  std::vector<std::pair<double, int>> near_;
};

}  // namespace strata::memory
