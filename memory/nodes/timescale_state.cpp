// SPDX-License-Identifier: Apache-2.0
/// How a timescale memory becomes bytes and comes back.
#include <algorithm>

#include "core/base/state_archive.hpp"
#include "memory/nodes/config_bytes.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::memory {
namespace {

/// 2: a node may gather a day. Memories of version 1 have no level that learns by days.
/// 3: what was seen last, and when each node was needed last. A node that has slept since an older
/// version wrote it does without.
/// 4: samples and pairs may say "no nearer than", which older versions would take for damage.
/// 5: a day knows ends of days by clocks that were set back afterwards.
constexpr std::uint32_t kStateVersion = 5;

/// Run and robot share a number: files of before several robots could feed a memory have robot 0.
std::int64_t run_and_robot(const MemoryNode& node) {
  return static_cast<std::int64_t>(
      static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.last_robot)) << 32U |
      static_cast<std::uint32_t>(node.last_run));
}

struct Head {
  TimescaleConfig config;
  std::uint64_t seed = 0;
  std::uint64_t observations = 0;
  int newest_run = 0;
  Stamp newest_stamp;
  std::uint64_t newest_node = 0;
};

/// nodes: how many there must be.
Head read_head(std::span<const std::byte> bytes, std::size_t nodes, const std::string& place) {
  StateReader in(bytes, place);
  std::uint32_t version = 0;
  in(version);
  if (version > kStateVersion) {
    throw InputError(place, "was written by a newer Strata", "update Strata, or learn it again");
  }
  Head head;
  head.config = read_config(in);
  in(head.seed);
  in(head.observations);
  if (version >= 3) {
    in(head.newest_run);
    in(head.newest_stamp);
    in(head.newest_node);
    if (head.newest_node >= std::max<std::size_t>(nodes, 1)) in.fail("has lost its newest node");
  }
  std::uint64_t count = 0;
  in(count);
  if (count != nodes) in.fail("lacks nodes");
  in.expect_end();
  return head;
}

void read_node_head(MemoryNode& node, std::span<const std::byte> bytes, const std::string& place) {
  StateReader in(bytes, place);
  in(node.position_m.x());
  in(node.position_m.y());
  in(node.observations);
  std::int64_t run = 0;
  in(run);
  node.last_run = static_cast<int>(run & 0xffffffff);
  node.last_robot = run < 0 ? 0 : static_cast<int>(run >> 32);
  in(node.last_stamp);
  in(node.last_pose);
  if (!in.is_at_end()) in(node.last_used);
  in.expect_end();
  if (!node.position_m.allFinite() || !is_finite(node.last_pose)) in.fail("has a node nowhere");
}

template <typename Part>
std::vector<std::byte> bytes_of(const Part& part) {
  StateWriter out;
  out(part);
  return out.take_bytes();
}

template <typename Part>
void read_part(Part& part, std::span<const std::byte> bytes, const std::string& place) {
  StateReader in(bytes, place);
  in(part);
  in.expect_end();
}

}  // namespace

std::vector<std::byte> TimescaleMemory::head_state() const {
  StateWriter out;
  out(kStateVersion);
  write_config(config_, out);
  out(seed_);
  out(observations_);
  out(newest_run_);
  out(newest_stamp_);
  out(std::uint64_t{newest_node_});
  out(static_cast<std::uint64_t>(nodes_.size()));
  return out.take_bytes();
}

TimescaleMemory::NodeState TimescaleMemory::node_state(std::size_t index) const {
  const MemoryNode& node = nodes_[index];
  StateWriter head;
  head(node.position_m.x());
  head(node.position_m.y());
  head(node.observations);
  head(run_and_robot(node));
  head(node.last_stamp);
  head(node.last_pose);
  head(node.last_used);
  NodeState state{head.take_bytes(), {}};
  if (node.is_evicted()) {
    state.levels = source_->levels_of(index);
    return state;
  }
  for (const NodeLevel& level : node.levels) state.levels.push_back(bytes_of(level));
  if (node.today) state.levels.push_back(bytes_of(*node.today));
  return state;
}

std::vector<std::byte> TimescaleMemory::state() const {
  std::vector<std::byte> all = head_state();
  auto append = [&all](const std::vector<std::byte>& part) {
    all.insert(all.end(), part.begin(), part.end());
  };
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const NodeState node = node_state(n);
    append(node.head);
    for (const auto& level : node.levels) append(level);
  }
  return all;
}

std::size_t TimescaleMemory::bytes() const {
  // A node's head and, per level, insertions and two counts an angle bin.
  constexpr std::size_t kHeadBytes = 72;
  std::size_t total = head_state().size();
  for (const MemoryNode& node : nodes_) {
    total += kHeadBytes;
    for (const NodeLevel& level : node.levels) {
      total += 8 + 4 * static_cast<std::size_t>(config_.angle_bins);
      total += level.sample_count() * sizeof(float) + level.pair_count() * sizeof(RangePair);
    }
    if (node.today) total += node.today->bytes();
  }
  return total;
}

void TimescaleMemory::read_levels(MemoryNode& node, std::span<const std::vector<std::byte>> levels,
                                  const std::string& place) const {
  if (levels.size() != node.levels.size() + (node.today ? 1U : 0U)) {
    StateReader(std::span<const std::byte>(), place).fail("lacks levels");
  }
  for (std::size_t level = 0; level < node.levels.size(); ++level) {
    read_part(node.levels[level], levels[level], place);
  }
  if (node.today) read_part(*node.today, levels.back(), place);
}

TimescaleMemory TimescaleMemory::restore(std::span<const std::byte> head,
                                         std::span<const NodeState> nodes,
                                         const std::string& place) {
  Head read = read_head(head, nodes.size(), place);
  TimescaleMemory memory(std::move(read.config), read.seed);
  memory.observations_ = read.observations;
  memory.newest_run_ = read.newest_run;
  memory.newest_stamp_ = read.newest_stamp;
  memory.newest_node_ = read.newest_node;
  for (const NodeState& state : nodes) {
    MemoryNode& node = memory.nodes_[static_cast<std::size_t>(memory.add_node({0.0, 0.0}))];
    read_node_head(node, state.head, place);
    memory.read_levels(node, state.levels, place);
  }
  return memory;
}

TimescaleMemory TimescaleMemory::restore_evicted(std::span<const std::byte> head,
                                                 std::span<const std::vector<std::byte>> node_heads,
                                                 std::shared_ptr<const NodeSource> source) {
  const std::string place = source->place();
  Head read = read_head(head, node_heads.size(), place);
  TimescaleMemory memory(std::move(read.config), read.seed);
  memory.observations_ = read.observations;
  memory.newest_run_ = read.newest_run;
  memory.newest_stamp_ = read.newest_stamp;
  memory.newest_node_ = read.newest_node;
  memory.source_ = std::move(source);
  memory.nodes_.resize(node_heads.size());
  for (std::size_t n = 0; n < node_heads.size(); ++n) {
    read_node_head(memory.nodes_[n], node_heads[n], place);
  }
  return memory;
}

}  // namespace strata::memory
