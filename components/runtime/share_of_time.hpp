// SPDX-License-Identifier: Apache-2.0
/// How often a component does what it need not do at once: so seldom that scans do not wait for it.
#pragma once

#include <chrono>

namespace strata::runtime {

/// Of the wall clock, that such work may take.
inline constexpr double kShareOfTime = 0.05;

/// Work of that length may be done again after so long [s].
[[nodiscard]] inline double rest_after_s(double work_s) { return work_s / kShareOfTime; }

/// When work that was begun then, and has just been done, may be done again.
[[nodiscard]] inline std::chrono::steady_clock::time_point next_turn(
    std::chrono::steady_clock::time_point begin) {
  const auto now = std::chrono::steady_clock::now();
  const std::chrono::duration<double> work = now - begin;
  return now + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                   std::chrono::duration<double>(rest_after_s(work.count())));
}

}  // namespace strata::runtime
