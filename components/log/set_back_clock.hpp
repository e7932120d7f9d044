// SPDX-License-Identifier: Apache-2.0
/// Logs whose clock was set back while they were recorded.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace strata::log {

/// How the stamps of a stream were mended.
struct SetBackClock {
  std::size_t times = 0;
  double first_s = 0.0;     ///< when it was set back first, from the first message on
  double furthest_s = 0.0;  ///< by how much, at most

  /// For people; empty when nothing was mended.
  [[nodiscard]] std::string sentence() const;
};

/// stamps: in the order of recording. Where the clock was set back, sorting would mix messages from
/// two places; so what follows is moved, by whole seconds and all, to one period after the message
/// before. Left alone: a message that was only late (it fills a hole between earlier ones, or the
/// next one is in time again), a copy of an earlier one (same(i, j): i repeats j), and a clock set
/// back by less than a second. O(n log n).
[[nodiscard]] SetBackClock mend_set_back_clock(
    std::vector<Stamp>& stamps, const std::function<bool(std::size_t, std::size_t)>& same);

}  // namespace strata::log
