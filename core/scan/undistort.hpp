// SPDX-License-Identifier: Apache-2.0
/// Removes the robot's motion during a sweep from the sweep.
#pragma once

#include <span>

#include "core/scan/scan.hpp"

namespace strata {

/// When the beams of a sweep were taken, where that differs from what the message states.
struct SweepTiming {
  bool reversed = false;  ///< the last beam was taken first
  double delay_s = 0.0;   ///< the stamp lies this long after the first beam, by odometry's clock
};

/// Longer sweeps are a driver's nonsense (nanoseconds taken for seconds).
inline constexpr double kLongestSweepS = 2.0;

/// From the first beam to the last; zero where the message states nonsense.
[[nodiscard]] Duration sweep_duration(const Scan& scan);

/// The scan as if every beam had been taken at the time of the first one, for a robot that moves by
/// start_from_end during the whole sweep at constant velocity. Beam 0 is taken first, or the last
/// beam when the sweep is reversed. Bearings change a little with the motion; each corrected point
/// is put on the nearest beam of the same geometry, the closer one where two meet, and beams left
/// without a point become NaN. A scan with time_increment_s of 0 is returned as it is.
/// start_from_end: pose of the robot at the end of the sweep, in its frame at the start. O(beams).
[[nodiscard]] Scan undistort(const Scan& scan, const Pose2& start_from_end, bool reversed = false);

/// The same for a scan that says of each beam when it was taken after the stamp (before it, where
/// negative), for a robot that moves by start_from_end within the sweep_s after the stamp.
/// offset_s: one a beam.
[[nodiscard]] Scan undistort(const Scan& scan, std::span<const float> offset_s,
                             const Pose2& start_from_end, double sweep_s);

}  // namespace strata
