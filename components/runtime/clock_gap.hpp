// SPDX-License-Identifier: Apache-2.0
/// Whether scans and odometry, which both come, are by clocks further apart than their turns show.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include "core/base/time.hpp"
#include "core/registration/odometry_lag.hpp"

namespace strata::runtime {

/// A burst of old scans after a component was busy is no such gap, nor is a hole in odometry: it
/// has to last for scans and for seconds, by the stamps of either.
class ClockGap {
 public:
  /// A scan goes on, with odometry of its moment or without. newest: what has come by then.
  void add(bool has_odometry, Stamp newest_scan, Stamp newest_odometry) {
    ahead_s_ = (newest_scan - newest_odometry).seconds();
    if (has_odometry && ahead_s_ >= -registration::kMaxOdometryLagS) {
      scans_ = 0;
      return;
    }
    if (scans_++ > 0) return;
    first_scan_ = newest_scan;
    first_odometry_ = newest_odometry;
  }
  void begin_anew() { scans_ = 0; }

  /// By how much scans are stamped ahead of odometry, when that has lasted so long [s].
  [[nodiscard]] std::optional<double> ahead_s(double least_s, Stamp newest_scan,
                                              Stamp newest_odometry) const {
    const double lasted_s = std::max((newest_scan - first_scan_).seconds(),
                                     (newest_odometry - first_odometry_).seconds());
    if (scans_ < kLeastScans || lasted_s < least_s) return std::nullopt;
    return ahead_s_;
  }

 private:
  static constexpr std::size_t kLeastScans = 20;
  std::size_t scans_ = 0;  ///< in a row
  Stamp first_scan_;       ///< newest ones when the row began
  Stamp first_odometry_;
  double ahead_s_ = 0.0;
};

}  // namespace strata::runtime
