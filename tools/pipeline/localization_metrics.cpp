// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localization_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace strata::pipeline {
namespace {

constexpr double kLostDistance_m = 1.0;
constexpr double kHold_s = 5.0;

/// Index of the first scan from which the error stays below the failure distance for kHold_s.
std::optional<std::size_t> convergence_index(std::span<const ScanError> errors) {
  std::optional<std::size_t> begin;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (errors[i].error_m >= kFailureDistance_m) {
      begin.reset();
      continue;
    }
    if (!begin) begin = i;
    if ((errors[i].stamp - errors[*begin].stamp).seconds() >= kHold_s) return begin;
  }
  return begin;
}

/// Index of the first scan from which the error stays above the distance for kHold_s.
std::optional<std::size_t> lost_index(std::span<const ScanError> errors, double distance_m) {
  std::optional<std::size_t> begin;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (errors[i].error_m <= distance_m) {
      begin.reset();
      continue;
    }
    if (!begin) begin = i;
    if ((errors[i].stamp - errors[*begin].stamp).seconds() >= kHold_s) return begin;
  }
  return std::nullopt;
}

}  // namespace

LocalizationMetrics evaluate_run(std::span<const ScanError> errors) {
  LocalizationMetrics metrics;
  if (errors.empty()) return metrics;
  std::vector<double> distances;
  std::vector<double> angles;
  for (const ScanError& error : errors) {
    distances.push_back(error.error_m);
    angles.push_back(error.error_rad);
  }
  metrics.error_m = summarize(std::move(distances));
  metrics.error_rad = summarize(std::move(angles));

  const std::optional<std::size_t> converged = convergence_index(errors);
  if (converged) {
    metrics.converged_after_s = (errors[*converged].stamp - errors.front().stamp).seconds();
  }
  const std::span<const ScanError> counted = errors.subspan(converged.value_or(0));
  const auto failures = std::count_if(counted.begin(), counted.end(), [](const ScanError& error) {
    return error.error_m > kFailureDistance_m;
  });
  metrics.failure_rate = static_cast<double>(failures) / static_cast<double>(counted.size());
  const std::optional<std::size_t> lost = lost_index(counted, kLostDistance_m);
  metrics.lost = lost.has_value();
  if (!lost) return metrics;
  const std::span<const ScanError> after = counted.subspan(*lost);
  if (const std::optional<std::size_t> found = convergence_index(after)) {
    metrics.recovered_after_s = (after[*found].stamp - after.front().stamp).seconds();
  }
  return metrics;
}

}  // namespace strata::pipeline
