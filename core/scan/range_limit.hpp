// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace strata {

/// No planar scanner measures further, so a longer finite reading (1e30, or a driver's code for
/// nothing seen where range_max is infinite) is no place: taken for one it would have no cell, and
/// maps would grow towards it.
constexpr float kLongestRangeM = 1000.0F;

/// From where on a reading of a scan with that range_max says that nothing was seen; a
/// number even where range_max is none.
[[nodiscard]] inline float range_limit_m(float range_max_m) {
  return std::min(kLongestRangeM, range_max_m);
}

}  // namespace strata
