// SPDX-License-Identifier: Apache-2.0
#include "components/timescale_memory/memory_file.hpp"

#include "core/base/damage.hpp"

namespace strata::timescale_memory {

MemoryFile::MemoryFile(const std::string& path, double save_period_s, std::size_t resident_nodes)
    // To look for damage reads the whole file; what is read later has checksums of its own.
    : store_(path, {.check = false}),
      save_period_(save_period_s),
      resident_nodes_(resident_nodes) {}

memory::TimescaleMemory MemoryFile::resume(const memory::TimescaleConfig& config,
                                           std::uint64_t seed) {
  if (!store_.has_timescale()) return memory::TimescaleMemory(config, seed);
  memory::TimescaleMemory memory = open();
  if (!(memory.config() == config)) {
    throw ConfigError(store_.path().string(), "holds a timescale memory made with other settings",
                      "give the settings it was made with, or another store");
  }
  saved_ = memory::Store::all_saved(memory);
  return memory;
}

memory::TimescaleMemory MemoryFile::open() {
  try {
    return store_.open_timescale();
  } catch (const DamageError&) {
    store_.leave_as_is();
    throw;
  }
}

void MemoryFile::save(memory::TimescaleMemory& memory, bool force) {
  const Clock::time_point now = Clock::now();
  if (!force && now - last_save_ < save_period_) return;
  last_save_ = now;
  if (saved_.is_known && saved_.observations == memory.observations()) return;
  store_.save_timescale_changes(memory, saved_);
  memory.evict(resident_nodes_, store_.timescale_nodes());
}

}  // namespace strata::timescale_memory
