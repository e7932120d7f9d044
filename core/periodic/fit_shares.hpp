// SPDX-License-Identifier: Apache-2.0
/// Periodic shares from sightings by the hour of the week.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/periodic/periodic_shares.hpp"

namespace strata::periodic {

/// How often each state was seen in each hour of the week; parts of sightings count too.
class WeeklySightings {
 public:
  explicit WeeklySightings(std::size_t states) : states_(states), counts_(kHoursAWeek * states) {}
  [[nodiscard]] std::size_t states() const { return states_; }
  [[nodiscard]] double& at(int hour, std::size_t state) {
    return counts_[static_cast<std::size_t>(hour) * states_ + state];
  }
  [[nodiscard]] std::span<const double> of(int hour) const {
    return std::span(counts_).subspan(static_cast<std::size_t>(hour) * states_, states_);
  }

 private:
  std::size_t states_;
  std::vector<double> counts_;
};

/// The time of the week in the middle of an hour, in [0, 1).
[[nodiscard]] constexpr double middle_of_hour(int hour) { return (hour + 0.5) / kHoursAWeek; }

/// The posterior mode of multinomial logistic regression on waves of these cycles, each amplitude
/// with a normal density of stddev `amplitude`, by Newton's method from `begin` (its waves of other
/// cycles are ignored). O(steps x hours x (states x waves)^2).
[[nodiscard]] PeriodicShares fit_shares(const WeeklySightings& sightings,
                                        std::span<const int> cycles_a_week, double amplitude,
                                        const PeriodicShares& begin = {});

}  // namespace strata::periodic
