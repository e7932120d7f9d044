// SPDX-License-Identifier: Apache-2.0
/// Equality to the bit, which takes a NaN for equal to itself.
#pragma once

#include <cstring>
#include <vector>

#include "core/grid/grid.hpp"

namespace strata::test {

template <typename T>
[[nodiscard]] bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

template <typename T>
[[nodiscard]] bool same_bits(const Grid<T>& a, const Grid<T>& b) {
  return a.rect() == b.rect() && a.resolution_m() == b.resolution_m() &&
         std::memcmp(&a.fill(), &b.fill(), sizeof(T)) == 0 && same_bits(a.values(), b.values());
}

}  // namespace strata::test
