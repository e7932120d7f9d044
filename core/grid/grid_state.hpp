// SPDX-License-Identifier: Apache-2.0
/// Grids in saved states (core/base/state_archive.hpp).
#pragma once

#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/base/state_archive.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/tiled_grid.hpp"

namespace strata {

template <typename T>
void state_of(const Grid<T>& grid, StateWriter& archive) {
  archive(grid.resolution_m());
  archive(grid.rect());
  archive(grid.fill());
  archive(grid.values());
}

/// Throws DamageError for values that do not fill the rectangle, a rectangle that no robot reaches,
/// and cells without size.
template <typename T>
void state_of(Grid<T>& grid, StateReader& archive) {
  double resolution_m = 0.0;
  CellRect rect;
  T fill{};
  std::vector<T> values;
  archive(resolution_m);
  archive(rect);
  archive(fill);
  archive(values);
  // In 64 bits: damaged bounds may be anything.
  const std::int64_t width = std::int64_t{rect.max.x} - rect.min.x;
  const std::int64_t height = std::int64_t{rect.max.y} - rect.min.y;
  const bool is_filled =
      width >= 0 && height >= 0 && width < (std::int64_t{1} << 31) &&
      height < (std::int64_t{1} << 31) &&
      static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) == values.size();
  // Far from where adding to a coordinate overflows: 1,600 km at 0.05 m.
  constexpr int kFarthest = 1 << 25;
  const auto is_near = [](const Cell& cell) {
    return std::abs(std::int64_t{cell.x}) <= kFarthest &&
           std::abs(std::int64_t{cell.y}) <= kFarthest;
  };
  if (!is_filled || !is_near(rect.min) || !is_near(rect.max) || !(resolution_m > 0.0)) {
    archive.fail("has a damaged grid");
  }
  grid = Grid<T>(resolution_m, rect, fill);
  grid.values() = std::move(values);
}

/// Tiled grids as grids.
template <typename T>
void state_of(const TiledGrid<T>& grid, StateWriter& archive) {
  archive(grid.dense());
}
template <typename T>
void state_of(TiledGrid<T>& grid, StateReader& archive) {
  Grid<T> dense;
  archive(dense);
  grid = TiledGrid<T>(dense);
}

}  // namespace strata
