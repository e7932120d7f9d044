// SPDX-License-Identifier: Apache-2.0
/// The memory of a running robot on disk.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "memory/nodes/timescale_memory.hpp"
#include "memory/store/store.hpp"

namespace strata::timescale_memory {

/// Keeps a store up to date while the robot runs. One thread at a time.
class MemoryFile {
 public:
  /// Opens the store or makes it. resident_nodes: of how many nodes the levels stay in RAM. Throws
  /// InputError and OutputError.
  MemoryFile(const std::string& path, double save_period_s, std::size_t resident_nodes);

  /// The memory to go on with: what the store holds, its nodes evicted until they are needed, else
  /// a new one. Throws ConfigError when the store's was made with other settings, DamageError when
  /// it is damaged; its file stays as it is.
  [[nodiscard]] memory::TimescaleMemory resume(const memory::TimescaleConfig& config,
                                               std::uint64_t seed);
  /// Saves what has changed when the last save is save_period_s ago, or at once with `force`, and
  /// evicts nodes beyond resident_nodes. Throws OutputError; the next call tries again.
  void save(memory::TimescaleMemory& memory, bool force);

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] memory::TimescaleMemory open();

  memory::Store store_;
  std::chrono::duration<double> save_period_;
  std::size_t resident_nodes_;
  Clock::time_point last_save_ = Clock::now();
  memory::SavedTimescale saved_;
};

}  // namespace strata::timescale_memory
