// SPDX-License-Identifier: Apache-2.0
/// Doors with opening hours, and doors without: what is foretold of the first look of a day.
#pragma once

#include <cstdint>

namespace strata::experiments {

/// Sums over doors: squared errors of the probability that the door stands open, at the first look
/// of each day from day 30 on.
struct DoorTimes {
  int doors = 0;
  int followed = 0;  ///< doors whose shares were found to follow the time
  int mornings = 0;
  double in_time = 0.0;   ///< by the chain in time, where there is one
  double constant = 0.0;  ///< by the chain that does not know the time
  double oracle = 0.0;    ///< by the share that the door is drawn from at that time
};

/// One door, passed two to twelve times a day for 60 days, at hours of its own, by a robot that
/// takes it for something else in one of 20 looks. With opening hours it opens at some time from 6
/// to 10, closes from 15 to 22, follows that in 85 to 99% of the draws, and every second one stays
/// closed on two days of the week; without, it is open with one probability. It is drawn anew every
/// 2 minutes to 4 hours in the mean.
[[nodiscard]] DoorTimes door_times(std::uint64_t seed, bool has_hours);

/// Prints mean squared errors (Brier scores) of so many doors of each kind.
void report_door_times(std::uint64_t first_seed, int seeds);

}  // namespace strata::experiments
