// SPDX-License-Identifier: Apache-2.0
/// Whether scans see what a memory of before holds.
#pragma once

#include <cstddef>
#include <map>
#include <memory>

#include "core/grid/frame_watch.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/nodes/node_map.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::memory {

/// A memory as it was opened, before it learned: a node is looked at once.
class StoredPlaces {
 public:
  /// nodes: of the memory as it was opened.
  explicit StoredPlaces(std::size_t nodes) : nodes_(nodes) {}

  /// How many beams of a scan that the memory has not learned yet end within 0.3 m of where the
  /// slowest level that knows something expects it. Beams that hit what moves, and nodes that are
  /// damaged, are left out. Throws InputError when a node cannot be read. O(nodes + beams), and for
  /// each new node its decoding.
  [[nodiscard]] FrameLook agreement(const TimescaleMemory& memory, const DecodingConfig& decoding,
                                    const PosedScan& scan);

 private:
  [[nodiscard]] std::shared_ptr<const NodeMap::Level> level_of(const TimescaleMemory& memory,
                                                               const DecodingConfig& decoding,
                                                               std::size_t node);
  std::size_t nodes_;
  /// Of the nodes that were looked at; null: it knows nothing.
  std::map<std::size_t, std::shared_ptr<const NodeMap::Level>> levels_;
};

}  // namespace strata::memory
