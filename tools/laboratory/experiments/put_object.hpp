// SPDX-License-Identifier: Apache-2.0
/// An object put into real scans: the papers' robot stood while somebody placed one before it,
/// which no log of a driving robot shows.
#pragma once

#include <span>
#include <vector>

#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"
#include "tools/simulate/world.hpp"

namespace strata::experiments {

/// A board that stands across the way of the robot.
struct Board {
  double ahead_m = 0.0;  ///< of the scanner
  double width_m = 0.0;
};

/// Where it stands before the scanner of `scan`, in the frame of the poses.
[[nodiscard]] simulate::Segment placed(const Board& board, const PosedScan& scan);

/// Beams that would pass the board end on it, with `noise_m` standard deviation; all else, what the
/// scanner measured before it included, stays as it was. Readings below zero are no beams and stay,
/// too. O(scans x beams).
[[nodiscard]] std::vector<PosedScan> with_object(std::span<const PosedScan> scans,
                                                 const simulate::Segment& object, double noise_m,
                                                 RandomStream& random);

}  // namespace strata::experiments
