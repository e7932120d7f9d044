// SPDX-License-Identifier: Apache-2.0
/// The cells around a cell.
#pragma once

#include <cmath>
#include <vector>

#include "core/grid/grid.hpp"

namespace strata {

/// Offsets of the cells whose middles lie within radius_m >= 0 of a cell's middle, 0 among them,
/// row by row. Requires resolution_m > 0. O(cells).
[[nodiscard]] inline std::vector<Cell> disc(double radius_m, double resolution_m) {
  const double radius = radius_m / resolution_m + 1e-9;
  const int reach = static_cast<int>(std::floor(radius));
  std::vector<Cell> offsets;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (std::hypot(dx, dy) <= radius) offsets.push_back({dx, dy});
    }
  }
  return offsets;
}

}  // namespace strata
