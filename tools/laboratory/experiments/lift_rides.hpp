// SPDX-License-Identifier: Apache-2.0
/// Rides in lifts, and starts on an unknown level: how soon the level is right, and whether one is
/// ever sure of a wrong one.
#pragma once

#include <string>

#include "tools/laboratory/experiments/lift_building.hpp"
#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/shards/units.hpp"

namespace strata::experiments {

/// Sums over rides, or starts.
struct RidesOutcome {
  double rides = 0.0;
  double tellable = 0.0;  ///< 5% of the beams would have another length on each other level
                          ///< at last, and it has no twin
  double right = 0.0;     ///< of those, sure of the right level at the end
  double soon = 0.0;      ///< ... from 3 s after that on
  double after_s = 0.0;   ///< sum over the right ones
  double slowest_s = 0.0;
  double untold = 0.0;       ///< not tellable, and ambiguous at the end
  double guessed = 0.0;      ///< not tellable, and sure of the right level at the end
  double end_wrong = 0.0;    ///< sure of a wrong level at the end
  double ever_wrong = 0.0;   ///< rides with such a scan, at any time
  double wrong_scans = 0.0;  ///< of all rides
  double error_m = 0.0;      ///< sum over the right ones, at the end

  RidesOutcome& operator+=(const RidesOutcome& other);
};

[[nodiscard]] RidesOutcome one_ride(const LiftBuilding& building, const std::string& model,
                                    std::size_t from, std::size_t to, std::uint64_t seed);
/// The way out of the lift, begun without pose or level.
[[nodiscard]] RidesOutcome one_start(const LiftBuilding& building, const std::string& model,
                                     std::size_t level, std::uint64_t seed);

/// Ten rides a seed, two of which end where they began, and ten starts; prints a line for each
/// model.
void report_lift_rides(const Seeds& seeds, shards::Units& units);

}  // namespace strata::experiments
