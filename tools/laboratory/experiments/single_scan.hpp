// SPDX-License-Identifier: Apache-2.0
/// Where a robot is by one scan alone, in a map of the other scans of a log.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace strata::experiments {

/// A place is right within 1 m and 15 degrees of the scan's pose.
struct SingleScanCounts {
  std::size_t scans = 0;
  std::size_t found = 0;           ///< the right place is among the candidates
  std::size_t right = 0;           ///< ... and the likeliest one
  std::size_t accepted = 0;        ///< leads every other place by the margin
  std::size_t wrong_accepted = 0;  ///< ... and is not right
  double candidates = 0.0;         ///< mean number
  double mean_s = 0.0;             ///< of one core, search and ranking
  double max_s = 0.0;
};

/// Every tenth scan that has a pose is looked for in a map of the others (those with a pose of just
/// their stamp), without odometry. margin_nats: what accepts a place. step: of the tenth scans
/// every step-th only. Throws InputError.
[[nodiscard]] SingleScanCounts locate_single_scans(const std::string& log, const std::string& poses,
                                                   double margin_nats, int step);

/// Prints a line a log. The margin is that of the table in docs/results.md.
void report_single_scans(const std::vector<std::string>& logs,
                         const std::vector<std::string>& poses, double margin_nats, int step);

}  // namespace strata::experiments
