// SPDX-License-Identifier: Apache-2.0
/// Whether a log's odometry and scans are stamped by one clock, and what is done where they are
/// not.
#pragma once

#include <string>

#include "components/log/log_reader.hpp"

namespace strata::log {

/// A lag less than this is left as it is: it bends no map, and is near what estimates scatter by.
inline constexpr double kMinOdometryLagS = 0.05;

/// What turns of the log's first scanner say of its odometry's stamps. Of scans that were corrected
/// by a sweep's timing, which has a delay of its own, the odometry that they were given is asked.
/// O(scans x beams + turns x lags).
[[nodiscard]] OdometryClock find_odometry_clock(const LogContent& content,
                                                const ReadReport& report);

/// Gives every scan the odometry whose stamp is its own plus lag_s, and odometry's samples stamps
/// less lag_s, of a log whose scans came with odometry of their own. O(n log n).
void shift_scan_odometry(LogContent& content, double lag_s);

/// For people: what was found and done; empty when nothing needs to be said.
[[nodiscard]] std::string sentence_of(const OdometryClock& clock);

}  // namespace strata::log
