// SPDX-License-Identifier: Apache-2.0
#include "core/grid/connected_cells.hpp"

namespace strata {

std::vector<Cell> take_component(Grid<std::uint8_t>& mask, const Cell& start, CellLink link) {
  const int reach = static_cast<int>(link);
  std::vector<Cell> component{start};
  mask.at(start) = 0;
  for (std::size_t i = 0; i < component.size(); ++i) {
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const Cell next{component[i].x + dx, component[i].y + dy};
        if (mask.get(next) == 0) continue;
        mask.at(next) = 0;
        component.push_back(next);
      }
    }
  }
  return component;
}

}  // namespace strata
