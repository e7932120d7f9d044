// SPDX-License-Identifier: Apache-2.0
/// Connected components of masks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/grid.hpp"

namespace strata {

/// How far apart, in rows and in columns, two cells of one component may lie.
enum class CellLink : std::uint8_t {
  kNeighbours = 1,  ///< the eight around a cell
  kOverAGap = 2,    ///< with one cell between them too
};

/// Cells of the mask connected with `start`, which comes first; they are cleared in the mask.
/// Requires mask.at(start) != 0. O(cells of the component).
[[nodiscard]] std::vector<Cell> take_component(Grid<std::uint8_t>& mask, const Cell& start,
                                               CellLink link);

/// Calls visit(std::vector<Cell>) with every component of the mask, in the order of their first
/// cells, row by row. O(cells of the mask).
template <typename Visit>
void for_each_component(Grid<std::uint8_t> mask, CellLink link, Visit&& visit) {
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i] != 0) visit(take_component(mask, mask.cell(i), link));
  }
}

}  // namespace strata
