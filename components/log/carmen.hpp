// SPDX-License-Identifier: Apache-2.0
/// CARMEN logs: FLASER, ODOM, ROBOTLASER1 (old and new format, metres and radians).
#pragma once

#include <filesystem>

#include "components/log/log_reader.hpp"

namespace strata::log {

/// Reads a log. Scans are sorted by the ipc stamp. Odometry at a scan is the message's own; the
/// laser's mounting is the median difference of laser and odometry pose, or, when the two drift
/// apart (a corrected log over raw odometry), PARAM robot_frontlaser_offset.
///
/// No returns of FLASER: 80 m and above (a SICK sends 81.83, 81.87, 81.91); besides, readings that
/// pile up where they end (settle_no_returns), as 50 or 51.x do. ROBOTLASER1 states its maximum.
/// All become +Inf.
[[nodiscard]] LogContent read_carmen(const std::filesystem::path& path, const ReadOptions& options,
                                     ReadReport& report);

/// The bearings and limits that a FLASER line of that many beams stands for; scan.ranges_m is set.
void set_flaser_geometry(Scan& scan, double field_of_view_deg);

/// Writes FLASER where it says everything about a scan, ROBOTLASER1 elsewhere, and ODOM between.
/// Numbers are written so that they read back to the same bits; +Inf becomes 81.83 (or the
/// scanner's maximum when that is longer), NaN stays "nan". Packed with gzip when the name ends in
/// .gz. Throws OutputError.
void write_carmen(const std::filesystem::path& path, const LogContent& content);

}  // namespace strata::log
