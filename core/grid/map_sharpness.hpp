// SPDX-License-Identifier: Apache-2.0
/// How sharp a map is: of two maps of one log, the one from better poses is sharper.
#pragma once

#include <cstddef>

#include "core/grid/reflection_grid.hpp"

namespace strata {

struct MapSharpness {
  /// Mean of -m log2 m - (1 - m) log2(1 - m) over the cells that are known and within a cell of an
  /// occupied one: 0 when every beam says the same of each cell. The free space far from walls
  /// would only thin it out.
  double entropy_bits = 0.0;
  /// Mean over the occupied cells of the shortest run of occupied cells through them, along the
  /// two axes and the two diagonals: a wall one cell thick has one resolution.
  double wall_thickness_m = 0.0;
  std::size_t occupied_cells = 0;
};

/// All zero for a map without occupied cells. O(cells + occupied cells x thickness).
[[nodiscard]] MapSharpness map_sharpness(const ReflectionGrid& map);

}  // namespace strata
