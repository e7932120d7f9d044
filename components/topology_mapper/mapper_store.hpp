// SPDX-License-Identifier: Apache-2.0
/// The way that a topology mapper has gone, in a file, so that a restarted one goes on from there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/scan/scan.hpp"
#include "core/topology/topology_mapper.hpp"
#include "memory/store/store.hpp"

namespace strata::topology_mapper {

/// Throws ConfigError for a store that others keep: the maps of a folder, or a timescale memory.
/// One that is damaged passes: opening it tells.
void require_way(const std::filesystem::path& file);

/// The scans that the mapper keeps with the poses that it gave them, landmarks as they were told,
/// and where it has come to. Everything else the mapper makes of them again: visits are what costs,
/// tracking is not done twice. Not thread-safe.
class MapperStore {
 public:
  /// Opens or makes the file. Throws InputError for one that is no store or damaged, OutputError.
  explicit MapperStore(const std::filesystem::path& file);

  /// Makes a new mapper what the one was that wrote this, but for `resume_from`, and gives where it
  /// had come to; nothing when no scan was written. O(scans + visits x a landmark update). Throws
  /// InputError; one that is damaged stays byte for byte as it is.
  [[nodiscard]] std::optional<topology::TrackedMoment> restore(topology::TopologyMapper& mapper);

  /// What the mapper has just been given: written by the next flush.
  void mark(Stamp stamp);
  void add(const PosedScan& kept);
  void came_to(const topology::TrackedMoment& newest);
  /// One transaction. Throws OutputError, and keeps what it could not write.
  void flush();

 private:
  /// A landmark that was told when so many scans had come.
  struct Mark {
    std::size_t after_scans = 0;
    Stamp stamp;
  };
  [[nodiscard]] std::optional<topology::TrackedMoment> restore_all(
      topology::TopologyMapper& mapper);

  memory::Store store_;
  std::size_t scans_ = 0;  // that were added, written or not
  std::vector<Mark> marks_;
  bool has_new_mark_ = false;
  std::vector<PosedScan> waiting_;
  std::optional<topology::TrackedMoment> newest_;
  bool has_moved_on_ = false;
};

}  // namespace strata::topology_mapper
