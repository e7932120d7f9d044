// SPDX-License-Identifier: Apache-2.0
/// Whether a running robot's odometry and scans are stamped by one clock.
#pragma once

#include <deque>
#include <optional>

#include "components/log/odometry_track.hpp"
#include "core/registration/odometry_lag.hpp"
#include "core/scan/scan.hpp"

namespace strata::runtime {

/// Reads turns off the scans of one scanner and compares them with those of odometry as it is
/// stamped (core/registration/odometry_lag), over the last eight parts that turn by a radian each.
/// Memory and time a scan are bounded.
class OdometryClockWatch {
 public:
  /// As it is stamped.
  void add(const log::OdometrySample& sample);
  /// Mounted scans of any scanner, in order of time; the first one's are looked at.
  void add(const Scan& scan);
  /// Odometry is in another frame, or a clock was set back.
  void begin_anew();
  /// What turns say now, twice in a row within a few hundredths of a second; nothing when they do
  /// not tell.
  [[nodiscard]] std::optional<double> lag_s() const { return lag_s_; }

 private:
  void count(const registration::ScanTurn& turn);

  log::OdometryTrack track_;
  std::optional<Scan> last_;
  std::deque<registration::ScanTurn> waiting_;  ///< until odometry has gone on long enough
  std::deque<registration::LagPart> parts_;
  std::optional<double> found_s_;  ///< by the last part
  std::optional<double> lag_s_;
};

}  // namespace strata::runtime
