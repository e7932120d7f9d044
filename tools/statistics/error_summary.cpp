// SPDX-License-Identifier: Apache-2.0
#include "tools/statistics/error_summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace strata::statistics {

ErrorSummary summarize(std::vector<double> values) {
  ErrorSummary summary;
  if (values.empty()) return summary;
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  for (const double value : values) {
    summary.mean += value / n;
    summary.mean_squared += value * value / n;
  }
  for (const double value : values) {
    summary.stddev += (value - summary.mean) * (value - summary.mean) / n;
  }
  summary.stddev = std::sqrt(summary.stddev);
  summary.rmse = std::sqrt(summary.mean_squared);
  const std::size_t middle = values.size() / 2;
  summary.median =
      values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * n));
  summary.p95 = values[std::min(values.size(), std::max<std::size_t>(rank, 1)) - 1];
  summary.max = values.back();
  return summary;
}

}  // namespace strata::statistics
