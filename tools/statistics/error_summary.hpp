// SPDX-License-Identifier: Apache-2.0
/// What a list of errors comes to.
#pragma once

#include <vector>

namespace strata::statistics {

/// Mean, median, 95th percentile (nearest rank), maximum and root mean square of absolute values.
struct ErrorSummary {
  double mean = 0.0;
  double mean_squared = 0.0;
  double stddev = 0.0;
  double median = 0.0;
  double p95 = 0.0;
  double max = 0.0;
  double rmse = 0.0;
};
/// All zero for no values. O(n log n).
[[nodiscard]] ErrorSummary summarize(std::vector<double> values);

}  // namespace strata::statistics
