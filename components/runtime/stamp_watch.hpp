// SPDX-License-Identifier: Apache-2.0
/// Doubts a stamp far ahead of the one before it: behind one broken message, all that follow would
/// come too late for ever.
#pragma once

#include <cstdlib>
#include <optional>

#include "core/base/time.hpp"

namespace strata::runtime {

class StampWatch {
 public:
  static constexpr Duration kFar{60'000'000'000};

  /// False for a stamp further than kFar ahead of the last one that was believed. The second of two
  /// far ones that agree is believed: there was a gap, or the clock was set.
  [[nodiscard]] bool believes(Stamp stamp) {
    const bool is_far = last_ && stamp - *last_ > kFar;
    const bool agrees = doubted_ && std::llabs((stamp - *doubted_).ns) <= kFar.ns;
    doubted_.reset();
    if (is_far && !agrees) {
      doubted_ = stamp;
      return false;
    }
    last_ = stamp;
    return true;
  }

 private:
  std::optional<Stamp> last_;
  std::optional<Stamp> doubted_;
};

}  // namespace strata::runtime
