// SPDX-License-Identifier: Apache-2.0
/// Removes the robot's motion during a sweep from the sweep.
#pragma once

#include "core/scan/scan.hpp"

namespace strata {

/// The scan as if every beam had been taken at scan.stamp (the time of beam 0), for a robot that
/// moves by start_from_end during the whole sweep at constant velocity. Bearings change a little
/// with the motion; each corrected point is put on the nearest beam of the same geometry, the
/// closer one where two meet, and beams left without a point become NaN. A scan with
/// time_increment_s of 0 is returned as it is. start_from_end: pose of the robot at the last beam,
/// in its frame at beam 0. O(beams).
[[nodiscard]] Scan undistort(const Scan& scan, const Pose2& start_from_end);

}  // namespace strata
