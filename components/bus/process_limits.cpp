// SPDX-License-Identifier: Apache-2.0
#include "components/bus/process_limits.hpp"

#include <cstddef>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <sys/mman.h>

#include "core/base/error.hpp"

namespace strata::bus {
namespace {

/// A participant has 6 to 10.
constexpr int kThreads = 12;
/// For what it and its endpoints keep.
constexpr std::size_t kRoomBytes = 64U << 20U;

bool has_memory() {
  void* room =
      mmap(nullptr, kRoomBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) return false;
  munmap(room, kRoomBytes);
  return true;
}

/// Beside so many threads, each with its stack.
bool has_room() {
  std::mutex mutex;
  std::vector<std::jthread> threads;
  std::unique_lock lock(mutex);  // until all of them are there
  try {
    threads.reserve(kThreads);
    for (int i = 0; i < kThreads; ++i) {
      threads.emplace_back([&mutex] { const std::lock_guard wait(mutex); });
    }
  } catch (const std::exception&) {
    return false;
  }
  return has_memory();
}

}  // namespace

void require_room_for_participant() {
  if (has_room()) return;
  throw OutputError("limits of this process",
                    "leave too little for DDS, which takes " + std::to_string(kThreads) +
                        " threads and " + std::to_string(kRoomBytes >> 20U) + " MB at its start",
                    "raise the limits on address space (`ulimit -v`), processes (`ulimit -u`) and "
                    "memory");
}

}  // namespace strata::bus
