// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strata {

/// floor(value / by) of integers, by > 0: cells left of the origin go to the block left of it.
[[nodiscard]] constexpr int floor_divide(int value, int by) {
  return value >= 0 ? value / by : -((by - 1 - value) / by);
}

}  // namespace strata
