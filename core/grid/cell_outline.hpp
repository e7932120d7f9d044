// SPDX-License-Identifier: Apache-2.0
/// Sets of cells as polygons.
#pragma once

#include <vector>

#include "core/grid/grid.hpp"

namespace strata {

/// Corners of cells, (0, 0) being the lower left one of cell (0, 0); no three in a row lie on a
/// line, and the last is joined with the first.
using CellRing = std::vector<Cell>;

/// The outer ring goes counterclockwise, holes clockwise, as GeoJSON has them (RFC 7946).
struct CellPolygon {
  CellRing outer;
  std::vector<CellRing> holes;
};

/// The polygons that cover exactly these cells. Rings do not cross a corner where cells only touch:
/// there they come apart. In the order of their lowest, then leftmost corners. O(cells log cells).
[[nodiscard]] std::vector<CellPolygon> outline(const std::vector<Cell>& cells);

/// In cells; positive counterclockwise. O(corners).
[[nodiscard]] double signed_area(const CellRing& ring);

}  // namespace strata
