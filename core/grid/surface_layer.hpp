// SPDX-License-Identifier: Apache-2.0
/// Where in the cells of a map its surfaces lie: a wall is known to millimetres though cells are
/// centimetres wide.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/grid/grid.hpp"

namespace strata {

/// The surface in one cell, as its hits tell it: 12 bytes without padding, as it lies in files.
struct SurfaceCell {
  std::int32_t x = 0;  ///< the cell
  std::int32_t y = 0;
  std::uint8_t offset_x = 0;  ///< of the mean hit from the least corner, in 256ths of a cell
  std::uint8_t offset_y = 0;
  std::uint8_t normal = 0;  ///< direction of the normal, either sign, in 256ths of half a turn
  std::uint8_t tangential = 255;  ///< 0: a plane wall, 255: no direction, as a lone point
  friend bool operator==(const SurfaceCell&, const SurfaceCell&) = default;
};
static_assert(sizeof(SurfaceCell) == 12);

/// One entry a cell, sorted by row and column. Empty: nothing finer than the cells is known.
struct SurfaceLayer {
  double resolution_m = 0.0;
  std::vector<SurfaceCell> cells;

  [[nodiscard]] Cell cell(std::size_t i) const { return {cells[i].x, cells[i].y}; }
  /// Mean hit in the map frame, to a 512th of a cell.
  [[nodiscard]] Eigen::Vector2d position_m(std::size_t i) const {
    const SurfaceCell& surface = cells[i];
    return {(surface.x + (surface.offset_x + 0.5) / 256.0) * resolution_m,
            (surface.y + (surface.offset_y + 0.5) / 256.0) * resolution_m};
  }
};

}  // namespace strata
