// SPDX-License-Identifier: Apache-2.0
/// Whether odometry and scans of one moment carry the same stamp: clocks, drivers and slow serial
/// lines shift them against each other.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/registration/scan_turn.hpp"
#include "core/registration/sweep_timing.hpp"
#include "core/scan/scan.hpp"

namespace strata::registration {

/// How far the scanner turned between two moments by its readings.
struct ScanTurn {
  Stamp from;
  Stamp to;
  double turn_rad = 0.0;
};

/// Those of consecutive scans at most a second apart that `turn_between` can tell; of a scan whose
/// beams were taken one after the other the moment is the middle of its sweep. scans: of one
/// scanner and run, in time order. O(scans x turns x beams).
[[nodiscard]] std::vector<ScanTurn> turns_of(std::span<const Scan* const> scans,
                                             const ScanTurnConfig& config = {});

struct OdometryLag {
  /// Odometry of a scan's moment has the scan's stamp plus this; positive: its stamps are late. 0
  /// when not certain.
  double lag_s = 0.0;
  bool certain = false;
  double stddev_s = 0.0;      ///< of lag_s, by the scatter over parts of the log
  double cost = 0.0;          ///< of a turn at the best lag, in squared noise of a turn
  double cost_without = 0.0;  ///< ... without any lag
};

/// No lag is looked for beyond it.
inline constexpr double kMaxOdometryLagS = 2.0;

/// What the turns of a part of a log cost under each lag.
struct LagPart {
  std::vector<double> costs;
  std::size_t turns = 0;
  double turned_rad = 0.0;  ///< either way

  /// odometry: asked from kMaxOdometryLagS before the turn to as long after it. O(lags).
  void add(const ScanTurn& turn, const OdometryAt& odometry);
};

/// The lag under which turns agree best with odometry's, to a few hundredths of a second. Certain
/// when most parts that turned enough say the same, and it explains turns better than the usual
/// shift does; four parts at least. O(parts x lags).
[[nodiscard]] OdometryLag lag_of_parts(std::span<const LagPart> parts);

/// Compares the turns that scans show with those of odometry at stamps shifted by up to two seconds
/// either way, and takes the shift under which they agree best (lag_of_parts, for eight parts that
/// turn alike much), to the millisecond where odometry tells as much. Our own, not in the papers;
/// docs/theory/slam.md, "Odometry's clock". With more than 20,000 turns as many, evenly spread.
/// O(turns x shifts).
[[nodiscard]] OdometryLag estimate_odometry_lag(std::span<const ScanTurn> turns,
                                                const OdometryAt& odometry);

}  // namespace strata::registration
