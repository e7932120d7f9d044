// SPDX-License-Identifier: Apache-2.0
/// Memory that a long-lived process has freed goes back to the system.
///
/// glibc gives each thread an arena and shrinks it from its end only: what a rare large piece of
/// work freed (maps learned again, a folder saved) stays with the process below the first block
/// that is still in use. A process that mapped and learned held 560 MB so after nine hours, 176 MB
/// of them in use.
#pragma once

#include <chrono>
#include <cstddef>

namespace strata::runtime {

/// Resident memory of this process [bytes]; 0 where the system does not tell.
[[nodiscard]] std::size_t resident_bytes();

/// Gives back what is free in every arena. Other threads wait for it when they allocate from the
/// arena that is just gone through: a millisecond for every 25 MB that go back (measured: four
/// arenas, 350 MB, 13 ms). Nothing is done without glibc.
void return_free_memory();

/// When to do it: where the process has grown by so much since, and at most once a minute.
class FreeMemoryTurn {
 public:
  static constexpr std::size_t kGrowth_bytes = 16U << 20U;
  static constexpr std::chrono::seconds kRest{60};

  /// Returns free memory when it is due. The first call may do so at once.
  /// @return whether it was done
  bool take(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());

 private:
  std::chrono::steady_clock::time_point next_{};
  std::size_t resident_after_ = 0;
};

}  // namespace strata::runtime
