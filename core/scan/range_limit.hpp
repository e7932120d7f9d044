// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strata {

/// No planar scanner measures further, so a longer finite reading (1e30, or a driver's code for
/// nothing seen where range_max is infinite) is no place: taken for one it would have no cell, and
/// maps would grow towards it.
constexpr float kLongestRangeM = 1000.0F;

/// Whether a range_max says how far its scanner sees. Drivers that do not know leave it 0; others
/// say infinity, or something that is longer than any planar scanner sees.
[[nodiscard]] inline bool tells_reach(float range_max_m) {
  return range_max_m > 0.0F && range_max_m < kLongestRangeM;  // false for NaN
}

/// From where on a reading of a scan with that range_max says that nothing was seen; a
/// number even where range_max is none.
[[nodiscard]] inline float range_limit_m(float range_max_m) {
  return tells_reach(range_max_m) ? range_max_m : kLongestRangeM;
}

}  // namespace strata
