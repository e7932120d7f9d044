// SPDX-License-Identifier: Apache-2.0
/// What nav2 makes of the values of a grid message, by the formulas of its documentation.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace strata::test::nav2 {

inline constexpr int kLethal = 254;
inline constexpr int kInscribed = 253;
inline constexpr int kNoInformation = 255;

/// The static layer with `trinary_costmap: false`.
inline int static_cost(std::int8_t value, int lethal_threshold) {
  if (value < 0) return kNoInformation;
  if (value >= lethal_threshold) return kLethal;
  return static_cast<int>(static_cast<double>(value) / lethal_threshold * kLethal);
}

/// The KeepoutFilter: what the costmap's cell becomes.
inline int kept_out_cost(std::int8_t mask, int cost) {
  if (mask < 0) return cost;
  const int wanted = static_cast<int>(std::lround(mask * kLethal / 100.0));
  return wanted > cost || cost == kNoInformation ? wanted : cost;
}

/// The SpeedFilter with limits in percent: none of 0, which means no limit, and nothing where it
/// refuses the mask.
inline std::optional<double> speed_limit(std::int8_t mask, float base, float multiplier) {
  if (mask < 0) return std::nullopt;
  if (mask == 0) return 0.0;
  const double limit = static_cast<double>(base) + static_cast<double>(multiplier) * mask;
  return limit < 0.0 || limit > 100.0 ? 0.0 : limit;
}

}  // namespace strata::test::nav2
