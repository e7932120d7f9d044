// SPDX-License-Identifier: Apache-2.0
#include "core/grid/map_sharpness.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strata {
namespace {

double entropy_bits(double m) {
  if (m <= 0.0 || m >= 1.0) return 0.0;
  return -m * std::log2(m) - (1.0 - m) * std::log2(1.0 - m);
}

/// Occupied cells in a row through an occupied cell, itself included.
int run_length(const ReflectionGrid& map, const Cell& cell, const Cell& step) {
  int count = 1;
  for (const int sign : {-1, 1}) {
    Cell next{cell.x + sign * step.x, cell.y + sign * step.y};
    while (is_occupied(map.get(next))) {
      ++count;
      next = {next.x + sign * step.x, next.y + sign * step.y};
    }
  }
  return count;
}

double thickness_cells(const ReflectionGrid& map, const Cell& cell) {
  const int straight = std::min(run_length(map, cell, {1, 0}), run_length(map, cell, {0, 1}));
  const int slanted = std::min(run_length(map, cell, {1, 1}), run_length(map, cell, {1, -1}));
  return std::min(static_cast<double>(straight), std::numbers::sqrt2 * slanted);
}

}  // namespace

MapSharpness map_sharpness(const ReflectionGrid& map) {
  MapSharpness result;
  std::size_t judged = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const float m = map.values()[i];
    if (!is_known(m)) continue;
    const Cell cell = map.cell(i);
    if (!is_by_a_wall(map, cell)) continue;
    ++judged;
    result.entropy_bits += entropy_bits(static_cast<double>(m));
    if (!is_occupied(m)) continue;
    ++result.occupied_cells;
    result.wall_thickness_m += map.resolution_m() * thickness_cells(map, cell);
  }
  if (judged > 0) result.entropy_bits /= static_cast<double>(judged);
  if (result.occupied_cells > 0) {
    result.wall_thickness_m /= static_cast<double>(result.occupied_cells);
  }
  return result;
}

}  // namespace strata
