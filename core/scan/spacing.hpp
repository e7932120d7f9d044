// SPDX-License-Identifier: Apache-2.0
/// Fewer scans of a drive, where all are more than one wants to send.
#pragma once

#include <span>
#include <vector>

#include "core/scan/scan.hpp"

namespace strata {

struct SpacingConfig {
  double spacing_m = 0.0;  ///< 0: every scan stays
  double spacing_rad = 0.5;
  double spacing_s = 10.0;  ///< of a robot that stands
};

/// The first scan of a run, the last, and each that is as far as this, or turned so far, or so late
/// after the last one that stays. What was thinned so stays as it is when it is thinned again.
/// Requires scans of one run in order of time. O(scans).
[[nodiscard]] std::vector<PosedScan> spaced(std::span<const PosedScan> scans,
                                            const SpacingConfig& config);

}  // namespace strata
