// SPDX-License-Identifier: Apache-2.0
// What a model of timescale levels has learned in a run, as bytes and back.
#include <algorithm>
#include <utility>

#include "components/maps/timescale_model.hpp"
#include "core/base/state_archive.hpp"

namespace strata::maps {
namespace {

using memory::NodeMap;
using memory::TimescaleMemory;

/// The same map with a look-up table that no earlier map had a part in.
std::shared_ptr<const NodeMap> renewed(const NodeMap& map, std::vector<NodeMap::Node> nodes) {
  return std::make_shared<const NodeMap>(map.bins(), map.decoding(), map.level_names(),
                                         std::move(nodes));
}

void write(const std::vector<std::byte>& bytes, StateWriter& out) {
  out(static_cast<std::uint64_t>(bytes.size()));
  out.values(std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
}

std::vector<std::byte> read(StateReader& in) {
  std::vector<std::byte> bytes(in.length(1));
  in.values(std::span(reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()));
  return bytes;
}

/// Whether the node is the one that the memory began with, but for its head.
bool is_untouched(const TimescaleMemory& own, const TimescaleMemory& first, std::size_t n) {
  if (n >= first.nodes().size()) return false;
  const memory::MemoryNode& now = own.nodes()[n];
  const memory::MemoryNode& then = first.nodes()[n];
  if (now.is_evicted() || then.is_evicted()) return now.is_evicted();
  return now.revisions() == then.revisions();
}

/// Returns false when that takes more than max_bytes.
bool write(const TimescaleMemory& own, const TimescaleMemory& first, std::size_t max_bytes,
           StateWriter& out) {
  std::size_t bytes = 0;
  write(own.head_state(), out);
  out(own.turns());
  out(static_cast<std::uint64_t>(own.nodes().size()));
  for (std::size_t n = 0; n < own.nodes().size(); ++n) {
    TimescaleMemory::NodeState node = own.node_state(n);
    if (is_untouched(own, first, n)) node.levels.clear();
    for (const auto& level : node.levels) bytes += level.size();
    if (bytes > max_bytes) return false;
    write(node.head, out);
    out(static_cast<std::uint64_t>(node.levels.size()));
    for (const auto& level : node.levels) write(level, out);
  }
  return true;
}

TimescaleMemory read(const TimescaleMemory& first, const std::string& place, StateReader& in) {
  const std::vector<std::byte> head = read(in);
  ScannerTurns turns;
  in(turns);
  std::vector<TimescaleMemory::NodeState> nodes(in.length(2 * sizeof(std::uint64_t)));
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    nodes[n].head = read(in);
    nodes[n].levels.resize(in.length(sizeof(std::uint64_t)));
    for (auto& level : nodes[n].levels) level = read(in);
    if (!nodes[n].levels.empty()) continue;
    if (n >= first.nodes().size()) in.fail("lacks levels");
    nodes[n].levels = first.node_state(n).levels;
  }
  TimescaleMemory memory = TimescaleMemory::restore(head, nodes, place);
  if (!(memory.config() == first.config())) in.refuse("is of another memory");
  memory.set_turns(std::move(turns));
  return memory;
}

void write(const NodeMap& map, const NodeMap& first, StateWriter& out) {
  out(static_cast<std::uint64_t>(map.nodes().size()));
  for (std::size_t n = 0; n < map.nodes().size(); ++n) {
    const NodeMap::Node& node = map.nodes()[n];
    out(node.position_m.x());
    out(node.position_m.y());
    out(node.observations);
    out(node.is_pending);
    for (std::size_t l = 0; l < node.levels.size(); ++l) {
      const NodeMap::Level& level = *node.levels[l];
      const bool is_first = n < first.nodes().size() && first.nodes()[n].levels[l].get() == &level;
      out(is_first);
      if (is_first) continue;
      out(level.insertions);
      out(level.scan.range_m);
      out(level.scan.cost);
      out(level.scan.inconsistent);
    }
  }
}

std::vector<NodeMap::Node> read(const NodeMap& first, double own_place_m, StateReader& in) {
  std::vector<NodeMap::Node> nodes(in.length(3 * sizeof(double)));
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    NodeMap::Node& node = nodes[n];
    in(node.position_m.x());
    in(node.position_m.y());
    in(node.observations);
    in(node.is_pending);
    if (!node.position_m.allFinite()) in.fail("has a node nowhere");
    for (std::size_t l = 0; l < first.level_names().size(); ++l) {
      bool is_first = false;
      in(is_first);
      if (is_first) {
        if (n >= first.nodes().size()) in.fail("lacks levels");
        node.levels.push_back(first.nodes()[n].levels[l]);
        continue;
      }
      std::uint64_t insertions = 0;
      memory::DecodedScan scan;
      in(insertions);
      in(scan.range_m);
      in(scan.cost);
      in(scan.inconsistent);
      if (scan.range_m.size() != static_cast<std::size_t>(first.bins().angle_bins)) {
        in.fail("has other bins");
      }
      node.levels.push_back(
          NodeMap::make_level(first.bins(), own_place_m, insertions, std::move(scan)));
    }
  }
  return nodes;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> TimescaleModel::save_learned(std::size_t max_bytes) {
  StateWriter out;
  out(mixture_);
  out(node_);
  if (own_memory_) {
    if (!write(*own_memory_, *memory_, max_bytes, out)) return std::nullopt;
    write(*map_, *first_map_, out);
    map_ = renewed(*map_, map_->nodes());
  }
  std::vector<std::uint8_t> bytes = out.take();
  if (bytes.size() > max_bytes) return std::nullopt;
  return bytes;
}

void TimescaleModel::restore_learned(std::span<const std::uint8_t> bytes,
                                     const std::string& place) {
  StateReader in(bytes, place);
  in(mixture_);
  in(node_);
  if (own_memory_) {
    own_memory_ = read(*memory_, place, in);
    map_ = renewed(*map_, read(*first_map_, memory_->config().visibility.own_place_m, in));
    if (map_->nodes().size() > own_memory_->nodes().size()) in.fail("has a map of other nodes");
  }
  in.expect_end();
  if (node_ < -1 || node_ >= static_cast<int>(map_->nodes().size())) in.fail("is nowhere");
}

}  // namespace strata::maps
