// SPDX-License-Identifier: Apache-2.0
/// What one angle bin holds, counted by range bins: the states of a row of the graph.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "memory/levels/node_level.hpp"

namespace strata::memory::detail {

/// Most states of a row: every range bin and the overflow bin.
inline constexpr std::size_t kMaxStates = 256;
inline constexpr std::uint8_t kNoState = 255;

/// Where the samples of one angle bin lie. A sample "no nearer than f" counts for all that lie
/// further, in equal parts: for those range bins, and for others of its kind (redistribution to the
/// right [efron1967two]). What is left behind the furthest range is a state of its own,
/// beyond_bin(). The counts are then the product-limit estimate [kaplan1958nonparametric] times the
/// number of samples.
struct RowCounts {
  std::vector<std::uint8_t> states;  ///< range bins with samples, ascending
  // Only the level's range bins are filled, and those that their neighbours look at.
  std::array<std::uint8_t, kMaxStates> place;  ///< of a range bin in `states`; kNoState
  std::array<double, kMaxStates> count;        ///< samples per range bin
  std::size_t total = 0;
  /// What of one sample without a range counts for each state, in the mean; empty: there is none.
  std::vector<double> spread;

  void fill(const NodeLevel& level, int angle_bin) {
    const PolarBins& bins = level.bins();
    states.clear();
    spread.clear();
    const int used = std::min(static_cast<int>(kMaxStates), bins.beyond_bin() + 2);
    std::fill_n(place.begin(), used, kNoState);
    std::fill_n(count.begin(), used, 0.0);
    total = level.samples(angle_bin).size();
    std::size_t beyond = 0;
    for (const float range_m : level.samples(angle_bin)) {
      if (range_m < 0.0F) {
        ++beyond;
      } else {
        count[bins.range_bin(range_m)] += 1.0;
      }
    }
    if (beyond > 0) redistribute(level.samples(angle_bin), bins);
    for (int i = 0; i <= (beyond > 0 ? bins.beyond_bin() : bins.overflow_bin()); ++i) {
      const auto bin = static_cast<std::size_t>(i);
      if (count[bin] <= 0.0) continue;
      place[bin] = static_cast<std::uint8_t>(states.size());
      states.push_back(static_cast<std::uint8_t>(bin));
      if (beyond > 0) spread.push_back(moved_[bin] / static_cast<double>(beyond));
    }
  }
  [[nodiscard]] bool empty() const { return states.empty(); }
  /// Share of the samples in this range bin or one beside it.
  [[nodiscard]] double smooth_share(std::uint8_t bin) const { return weighted_share(bin, 1.0); }
  /// The same; samples in range bins beside it count `beside`.
  [[nodiscard]] double weighted_share(std::uint8_t bin, double beside) const {
    const double around =
        (bin > 0 ? count[bin - 1U] : 0.0) + (bin + 1U < kMaxStates ? count[bin + 1U] : 0.0);
    return (count[bin] + beside * around) / static_cast<double>(total);
  }

 private:
  void redistribute(std::span<const float> samples, const PolarBins& bins) {
    // Of a sample "no nearer than f" it is the range bin of f that may hold the surface.
    std::array<std::uint16_t, kMaxStates> ends;
    std::fill_n(ends.begin(), bins.overflow_bin() + 1, std::uint16_t{0});
    for (const float range_m : samples) {
      if (range_m < 0.0F) ++ends[bins.range_bin(-range_m)];
    }
    double left = static_cast<double>(total);     // samples of further surfaces, in the estimate
    double at_risk = static_cast<double>(total);  // ... that were looked for there
    for (int i = 0; i <= bins.overflow_bin(); ++i) {
      const auto bin = static_cast<std::size_t>(i);
      at_risk -= ends[bin];
      const double hits = count[bin];
      moved_[bin] = 0.0;
      if (hits <= 0.0) continue;
      count[bin] = left * hits / at_risk;
      moved_[bin] = count[bin] - hits;
      left = hits < at_risk ? left - count[bin] : 0.0;
      at_risk -= hits;
    }
    const auto bin = static_cast<std::size_t>(bins.beyond_bin());
    moved_[bin] = count[bin] = left;
  }
  std::array<double, kMaxStates> moved_;  ///< counts that came from samples without a range
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

/// Calls visit(alpha, beta, weight) for the range bins of every pair of the rows; of one without a
/// range for all that it may stand for.
template <typename Visit>
void for_each_pair(const NodeLevel& level, int angle_bin, const RowCounts& from,
                   const RowCounts& to, Visit&& visit) {
  const int beyond_bin = level.bins().beyond_bin();
  const auto for_targets = [&](const RowCounts& row, std::uint8_t bin, auto&& take) {
    if (bin != beyond_bin || row.spread.empty()) return take(bin, 1.0);
    for (std::size_t i = 0; i < row.states.size(); ++i) {
      if (row.spread[i] > 0.0) take(row.states[i], row.spread[i]);
    }
  };
  for (const RangePair& pair : level.pairs(angle_bin)) {
    for_targets(from, pair.alpha, [&](std::uint8_t alpha, double of_alpha) {
      for_targets(to, pair.beta, [&](std::uint8_t beta, double of_beta) {
        visit(alpha, beta, of_alpha * of_beta);
      });
    });
  }
}

}  // namespace strata::memory::detail
