// SPDX-License-Identifier: Apache-2.0
/// Which readings of a scanner mean that nothing came back, where nobody says so: found from all of
/// its readings.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scan/scan.hpp"

namespace strata {

/// Readings that pile up where a scanner's readings end.
struct NoReturnCode {
  float from_m = 0.0F;  ///< the least and the greatest of them
  float to_m = 0.0F;
  std::size_t readings = 0;
  std::size_t below = 0;  ///< in the metre below: what a wall there would have as company
};

/// A scan, and where the robot was by its odometry; anywhere, but the same for all, without.
struct PlacedScan {
  const Scan* scan = nullptr;
  Pose2 odom_from_robot;
};

/// Scanners send a number of their own where nothing came back: 81.91, 50, 51.05 to 51.16, or just
/// their reach. Such a number is told from walls by four things:
///
/// - Next to nothing lies above it: 2 readings and 2% of the pile.
/// - It is narrow: at most 0.3 m with its scatter.
/// - It stands out: ten times as dense as what lies below, at least 20 readings and 0.05% of all.
/// - It goes neither with a place nor with a direction. A wall piles up as well while the robot
///   stands, but then from one place half a metre wide: without the place that has most of it, it
///   still has to be a pile, unless the robot never moves. A wall along which the robot drives
///   piles up in one direction: 15% of all beams and five at least have to show it, or a quarter as
///   many as there are readings, or it is seen in half of the world's directions.
///
/// Returns the codes from the top, two at most; readings from the last one on are no returns. Only
/// beams that Scan::kind takes for hits count, of more than 1 m. scans: of one scanner.
/// Deterministic. O(beams).
[[nodiscard]] std::vector<NoReturnCode> find_no_return_codes(std::span<const PlacedScan> scans);

/// Turns what `Scan::kind` takes for no return at that limit into +Inf, and makes it the scan's
/// range_max. O(beams).
void set_range_limit(Scan& scan, float limit_m);

}  // namespace strata
