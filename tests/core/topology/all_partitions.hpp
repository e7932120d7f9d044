// SPDX-License-Identifier: Apache-2.0
/// Every partition of a few visits, and closed forms for how many there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/topology/partition.hpp"

namespace strata::topology {

/// Calls visit with every partition of n visits, in lexicographic order; there are bell_number(n).
template <typename Visit>
void for_each_partition(std::size_t n, Visit&& visit) {
  Labels labels(n, 0);
  std::vector<int> highest(n, 0);  // among labels[0..i]
  for (;;) {
    visit(labels);
    std::size_t i = n;
    while (i > 1 && labels[i - 1] > highest[i - 2]) --i;
    if (i <= 1) return;
    --i;
    ++labels[i];
    highest[i] = std::max(highest[i - 1], labels[i]);
    for (std::size_t k = i + 1; k < n; ++k) {
      labels[k] = 0;
      highest[k] = highest[i];
    }
  }
}

/// How many partitions n elements have. Requires n <= 25, beyond which 64 bits do not hold it.
inline std::uint64_t bell_number(std::size_t n) {
  // Bell's triangle: each row begins with the last of the row before.
  std::vector<std::uint64_t> row{1};
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::uint64_t> next{row.back()};
    for (const std::uint64_t value : row) next.push_back(next.back() + value);
    row = std::move(next);
  }
  return row.front();
}

/// Expected number of distinct landmarks after n visits: sum over i < n of c / (i + c). O(n).
inline double expected_landmarks(std::size_t n, double concentration) {
  double expected = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    expected += concentration / (static_cast<double>(i) + concentration);
  }
  return expected;
}

}  // namespace strata::topology
