// SPDX-License-Identifier: Apache-2.0
/// How often something may be done that takes longer and longer.
#pragma once

#include <chrono>

namespace strata::volume_mapper {

/// Leaves nine tenths of the time to everything else. Of the steady clock.
class ShareOfTime {
 public:
  using Clock = std::chrono::steady_clock;
  /// Whether it may be done again.
  [[nodiscard]] bool is_due(Clock::time_point now) const { return now >= next_; }
  /// It was done.
  void spent(Clock::time_point begin, Clock::time_point end) { next_ = end + 9 * (end - begin); }

 private:
  Clock::time_point next_ = Clock::time_point::min();
};

}  // namespace strata::volume_mapper
