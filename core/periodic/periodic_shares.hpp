// SPDX-License-Identifier: Apache-2.0
/// How often each of several states is there, by the time of day and of the week
/// (docs/theory/habits.md).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/time.hpp"

namespace strata::periodic {

inline constexpr int kHoursAWeek = 168;
inline constexpr int kDaysAWeek = 7;

/// One wave in the logits of all states, one entry a state:
/// cosine_k cos(2 pi cycles w) + sine_k sin(2 pi cycles w), w in [0, 1) the time of the week.
struct Harmonic {
  int cycles_a_week = 0;  ///< 7: once a day
  std::vector<double> cosine;
  std::vector<double> sine;
  bool operator==(const Harmonic&) const = default;
};

/// share_k(t) = exp(logit_k + waves_k(t)) / sum over all states. Without harmonics shares do not
/// depend on the time. A week begins where its stamps are a multiple of 7 days: which day and hour
/// that is does not matter, as long as the clock is not set anew.
struct PeriodicShares {
  std::vector<double> logit;
  std::vector<Harmonic> harmonics;
  [[nodiscard]] bool is_periodic() const { return !harmonics.empty(); }
  bool operator==(const PeriodicShares&) const = default;
};

/// The time of the week, in [0, 1).
[[nodiscard]] double part_of_week(Stamp stamp);
/// The hour of the week, in [0, 168).
[[nodiscard]] int hour_of_week(Stamp stamp);
/// The day since the epoch, and the week since then that a day belongs to.
[[nodiscard]] std::int64_t day_of(Stamp stamp);
[[nodiscard]] std::int64_t week_of_day(std::int64_t day);

/// The shares at a time of the week; they sum to 1. Requires room for as many as there are logits.
/// O(states x harmonics).
void shares_at(const PeriodicShares& periodic, double part_of_week, std::span<double> shares);

/// Whether every wave has an entry a state, all of them finite.
[[nodiscard]] bool is_sound(const PeriodicShares& periodic);

}  // namespace strata::periodic
