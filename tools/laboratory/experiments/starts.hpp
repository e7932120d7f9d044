// SPDX-License-Identifier: Apache-2.0
/// Starts without a pose, anywhere along a drive: how many end at the right place, how many are
/// sure of a wrong one, and how many do not tell.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/laboratory/experiments/verdict_worlds.hpp"
#include "tools/shards/units.hpp"

namespace strata::experiments {

/// Sums over starts.
struct StartsOutcome {
  double starts = 0.0;
  double right = 0.0;          ///< sure of the right place in the end
  double wrong = 0.0;          ///< sure of a wrong place in the end
  double ever_wrong = 0.0;     ///< sure of a wrong place for ten weighed scans on end
  double right_after_s = 0.0;  ///< sum over the right ones, until they were sure
  double scans = 0.0;
  double high_scored = 0.0;        ///< scans of a score of 0.9 or more
  double high_scored_wrong = 0.0;  ///< of those, more than 0.5 m off

  StartsOutcome& operator+=(const StartsOutcome& other);
};

/// Starts evenly along the drive, each followed for `scans` scans. Sure: is_sure. Wrong: more than
/// 1 m off.
[[nodiscard]] StartsOutcome start_anywhere(const VerdictWorld& world, const std::string& model,
                                           bool has_search, int starts, std::size_t scans);

/// Prints a line for each kind of world, model, and way to search: random offices and floors, with
/// scanners of 4 m and more, floors with boxes that nobody knows, and the decisive door, closed and
/// open.
void report_starts(const std::string& scenarios, const Seeds& seeds, shards::Units& units);

/// The same on logs with poses, maps of the first 60% of each.
void report_starts_of_logs(const std::vector<std::string>& logs,
                           const std::vector<std::string>& poses);

}  // namespace strata::experiments
