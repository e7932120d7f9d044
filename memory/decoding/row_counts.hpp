// SPDX-License-Identifier: Apache-2.0
/// What one angle bin holds, counted by range bins: the states of a row of the graph.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "memory/levels/node_level.hpp"

namespace strata::memory::detail {

/// Most states of a row: every range bin and the overflow bin.
inline constexpr std::size_t kMaxStates = 256;
inline constexpr std::uint8_t kNoState = 255;

/// Where the samples of one angle bin lie.
struct RowCounts {
  std::vector<std::uint8_t> states;  ///< range bins with samples, ascending
  // Only the level's range bins are filled, and one more.
  std::array<std::uint8_t, kMaxStates> place;   ///< of a range bin in `states`; kNoState
  std::array<std::uint16_t, kMaxStates> count;  ///< samples per range bin
  std::size_t total = 0;

  void fill(const NodeLevel& level, int angle_bin) {
    states.clear();
    const int used = level.bins().overflow_bin() + 2;  // and one beyond, which neighbours look at
    std::fill_n(place.begin(), used, kNoState);
    std::fill_n(count.begin(), used, std::uint16_t{0});
    total = level.samples(angle_bin).size();
    for (const float range_m : level.samples(angle_bin)) ++count[level.bins().range_bin(range_m)];
    for (int i = 0; i <= level.bins().overflow_bin(); ++i) {
      const auto bin = static_cast<std::size_t>(i);
      if (count[bin] == 0) continue;
      place[bin] = static_cast<std::uint8_t>(states.size());
      states.push_back(static_cast<std::uint8_t>(bin));
    }
  }
  [[nodiscard]] bool empty() const { return states.empty(); }
  /// Share of the samples in this range bin or one beside it.
  [[nodiscard]] double smooth_share(std::uint8_t bin) const { return weighted_share(bin, 1.0); }
  /// The same; samples in range bins beside it count `beside`.
  [[nodiscard]] double weighted_share(std::uint8_t bin, double beside) const {
    const int around =
        (bin > 0 ? count[bin - 1U] : 0) + (bin + 1U < kMaxStates ? count[bin + 1U] : 0);
    return (count[bin] + beside * around) / static_cast<double>(total);
  }
};

/// Calls visit(state) for the states of a row at this range bin and, with reach 1, beside it.
template <typename Visit>
void for_states_near(const RowCounts& row, int range_bin, int reach, Visit&& visit) {
  const int low = std::max(0, range_bin - reach);
  const int high = std::min<int>(kMaxStates - 1, range_bin + reach);
  for (int bin = low; bin <= high; ++bin) {
    if (const std::uint8_t state = row.place[static_cast<std::size_t>(bin)]; state != kNoState) {
      visit(std::size_t{state});
    }
  }
}

}  // namespace strata::memory::detail
