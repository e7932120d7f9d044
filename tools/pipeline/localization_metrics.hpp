// SPDX-License-Identifier: Apache-2.0
/// What a localization run was worth, in the words of docs/theory/evaluation.md: error, failure,
/// lost, converged.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "tools/statistics/error_summary.hpp"

namespace strata::pipeline {

/// A scan further than this from the truth has failed.
inline constexpr double kFailureDistance_m = 0.5;

/// Error of one scan: the weighted mean distance of all particles from the truth
/// [stachniss2005patch, section V], before resampling.
struct ScanError {
  Stamp stamp;
  double error_m = 0.0;
  double error_rad = 0.0;
  double score = 0.0;  ///< what the localizer said of its pose: LocalizationResult::score
};

using statistics::ErrorSummary;
using statistics::summarize;

struct LocalizationMetrics {
  ErrorSummary error_m;
  ErrorSummary error_rad;
  /// Share of scans further than 0.5 m from the truth after convergence; of all scans when the run
  /// never converged.
  double failure_rate = 0.0;
  /// The error stayed above 1 m for 5 s or longer, after convergence or when there was none.
  bool lost = false;
  /// Seconds from the first scan to the first time from which the error stays below 0.5 m for 5 s
  /// (or to the end of the log when that comes first).
  std::optional<double> converged_after_s;
  /// When lost: seconds from where it was lost to the first time from which the error stays below
  /// 0.5 m for 5 s again; nothing when it never does.
  std::optional<double> recovered_after_s;
};

/// Requires errors in the order of their stamps. Warm-up is not excluded from the error summaries:
/// the paper's figure counts every scan. O(n log n).
[[nodiscard]] LocalizationMetrics evaluate_run(std::span<const ScanError> errors);

}  // namespace strata::pipeline
