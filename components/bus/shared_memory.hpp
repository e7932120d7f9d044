// SPDX-License-Identifier: Apache-2.0
/// What Fast DDS leaves in shared memory when a process is killed.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace strata::bus {

struct SweptMemory {
  std::size_t segments = 0;
  std::uintmax_t bytes = 0;
};

/// Where Linux keeps shared memory.
inline constexpr const char* kSharedMemoryFolder = "/dev/shm";

/// Removes segments whose process has died: half a megabyte to 64 MB each, under names that nobody
/// takes again. A living process holds a lock on its segment's `_el` file. What is younger than
/// `min_age` is left alone, since its owner may be about to take that lock; so are the small
/// files of ports, which Fast DDS itself mends when it opens them, and what other users own. Never
/// throws.
SweptMemory remove_orphaned_segments(
    const std::filesystem::path& folder = kSharedMemoryFolder,
    std::chrono::seconds min_age = std::chrono::seconds(10)) noexcept;

}  // namespace strata::bus
