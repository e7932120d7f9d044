// SPDX-License-Identifier: Apache-2.0
/// How far a scanner turned between two scans, told by their readings alone.
#pragma once

#include <optional>

#include "core/scan/scan.hpp"

namespace strata::registration {

struct ScanTurnConfig {
  double max_turn_rad = 0.7;       ///< between the two scans, at most
  double max_difference_m = 0.5;   ///< of two readings of one direction; more counts as this much
  double max_relative_cost = 0.5;  ///< of the best turn, against the mean over all turns
  int max_beams = 0;               ///< that are compared, evenly spread; 0: all
};

/// The turn, counter-clockwise, under which the two scans' readings agree best: the mean absolute
/// difference of readings in one direction, refined between beams by a parabola. What the scanner
/// moved meanwhile is left out, so that it says much of many pairs and little of one. Nothing when
/// the scans have other beams, share less than half of their directions, or agree hardly better
/// than under any turn. Our own, not in the papers. O(turns x max_beams).
[[nodiscard]] std::optional<double> turn_between(const Scan& before, const Scan& now,
                                                 const ScanTurnConfig& config = {});

}  // namespace strata::registration
