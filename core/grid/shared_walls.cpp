// SPDX-License-Identifier: Apache-2.0
#include "core/grid/shared_walls.hpp"

#include <cstddef>

namespace strata {

double shared_walls(const ReflectionGrid& before, const ReflectionGrid& now) {
  const auto has_wall_near = [&](const Cell& cell) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const float value = now.get({cell.x + dx, cell.y + dy});
        if (is_known(value) && is_occupied(value)) return true;
      }
    }
    return false;
  };
  std::size_t walls = 0;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const float value = before.values()[i];
    if (!is_known(value) || !is_occupied(value)) continue;
    ++walls;
    shared += has_wall_near(before.cell(i)) ? 1 : 0;
  }
  return walls == 0 ? 1.0 : static_cast<double>(shared) / static_cast<double>(walls);
}

}  // namespace strata
