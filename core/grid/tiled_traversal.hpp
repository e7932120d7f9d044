// SPDX-License-Identifier: Apache-2.0
/// Exact traversal of a segment through a tiled grid.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/grid/ray_traversal.hpp"
#include "core/grid/tiled_grid.hpp"

namespace strata {

/// Calls visit(T& value, double length_m) for each cell that the segment crosses: the same cells
/// and lengths, in the same order, as traverse_ray through a Grid, to the last bit. Allocates the
/// tiles that it comes through. Requires both end cells in the grid. O(cells crossed).
template <typename T, typename Visit>
void traverse_ray(TiledGrid<T>& grid, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                  Visit&& visit) {
  const detail::RayCourse course(from_m, to_m, grid.resolution_m());
  const auto stride = [](const Cell& step) {
    return static_cast<std::size_t>(step.y * (std::ptrdiff_t{1} << TiledGrid<T>::kPitchBits) +
                                    step.x);
  };
  const detail::IndexCursor cursor{grid.number(course.first), stride(course.major()),
                                   stride(course.minor())};
  typename TiledGrid<T>::Writer cells(grid);
  const auto visit_number = [&](std::size_t number, double length_m) {
    visit(cells[number], length_m);
  };
  // A ray that is parallel to an axis but for a rounding has no finite inverse.
  if (course.lines.left_a >= detail::kMinColumns && std::isfinite(course.lines.inverse_b)) {
    detail::walk_columns(course.lines, cursor, visit_number);
  } else {
    detail::walk_lines(course.lines, cursor, 0.0, visit_number);
  }
}

}  // namespace strata
