// SPDX-License-Identifier: Apache-2.0
/// Sums of numbers of which only the logarithms fit.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace strata {

/// ln of the sum over items of exp(log_of(item)). Requires one item. O(items).
template <typename Items, typename LogOf = std::identity>
[[nodiscard]] double log_sum_exp(const Items& items, const LogOf& log_of = {}) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const auto& item : items) highest = std::max<double>(highest, log_of(item));
  double sum = 0.0;
  for (const auto& item : items) sum += std::exp(log_of(item) - highest);
  return highest + std::log(sum);
}

}  // namespace strata
