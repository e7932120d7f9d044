// SPDX-License-Identifier: Apache-2.0
#include "core/grid/shared_walls.hpp"

#include <cstddef>

namespace strata {

double shared_walls(const ReflectionGrid& before, const ReflectionGrid& now) {
  std::size_t walls = 0;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!is_occupied(before.values()[i])) continue;
    ++walls;
    shared += is_by_a_wall(now, before.cell(i)) ? 1 : 0;
  }
  return walls == 0 ? 1.0 : static_cast<double>(shared) / static_cast<double>(walls);
}

}  // namespace strata
