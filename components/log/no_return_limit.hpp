// SPDX-License-Identifier: Apache-2.0
/// From where on the readings of a log's scanner say that nothing came back, and why.
#pragma once

#include <span>
#include <string>

#include "components/log/log_reader.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"

namespace strata::log {

/// A scan that may be changed, and where the robot was by its odometry.
struct RangedScan {
  Scan* scan = nullptr;
  Pose2 odom_from_robot;
};

/// Sets range_max, and makes what it puts behind it +Inf: options.max_range_m; or the codes of no
/// return that the readings tell (core/scan/no_return.hpp), where they lie below range_max. Else
/// the scans stay as they are. The report says what it was and why; a code is a warning. scans: of
/// one scanner, named `scanner` for people, not empty. stated: what range_max itself goes by.
/// O(beams).
void settle_no_returns(std::span<const RangedScan> scans, const std::string& scanner,
                       const std::string& stated, const ReadOptions& options, ReadReport& report);

}  // namespace strata::log
