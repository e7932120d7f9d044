// SPDX-License-Identifier: Apache-2.0
/// Exact traversal of a segment through the cells it crosses, with the length inside each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "core/grid/grid.hpp"

namespace strata {

/// Calls visit(Cell, double length_m) for each cell whose half-open square the segment from -> to
/// crosses, in order, from the cell of `from` to the cell of `to`; both end cells are always
/// visited, and the lengths sum to the length of the segment. A step through a lattice corner goes
/// diagonally: the two cells that the segment only touches are not visited. A segment of zero
/// length visits its one cell with length 0. `visit` may return bool; false ends the walk. O(cells
/// crossed), no allocation. After [amanatides1987fast], with the crossing parameters computed
/// afresh from the lattice line (not by adding up), so that errors do not grow along the ray.
/// Requires finite coordinates.
template <typename Visit>
void traverse_ray(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double resolution_m,
                  Visit&& visit) {
  const double scale = 1.0 / resolution_m;
  Cell cell = cell_at(from_m, resolution_m);
  const Cell last = cell_at(to_m, resolution_m);
  const double dx = to_m.x() - from_m.x();
  const double dy = to_m.y() - from_m.y();
  const double length_m = std::sqrt(dx * dx + dy * dy);
  const int step_x = dx > 0.0 ? 1 : -1;
  const int step_y = dy > 0.0 ? 1 : -1;
  int left_x = std::abs(last.x - cell.x);
  int left_y = std::abs(last.y - cell.y);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // In units of cells, so that lattice lines are whole numbers.
  const double start_x = from_m.x() * scale;
  const double start_y = from_m.y() * scale;
  const double inverse_x = left_x > 0 ? 1.0 / (dx * scale) : 0.0;
  const double inverse_y = left_y > 0 ? 1.0 / (dy * scale) : 0.0;
  const int line_x = step_x > 0 ? 1 : 0;
  const int line_y = step_y > 0 ? 1 : 0;
  auto crossing_x = [&] { return left_x > 0 ? (cell.x + line_x - start_x) * inverse_x : kNever; };
  auto crossing_y = [&] { return left_y > 0 ? (cell.y + line_y - start_y) * inverse_y : kNever; };
  auto call = [&visit](const Cell& at, double inside_m) {
    if constexpr (std::is_same_v<decltype(visit(at, inside_m)), bool>) {
      return visit(at, inside_m);
    } else {
      visit(at, inside_m);
      return true;
    }
  };
  double t = 0.0;
  double next_x = crossing_x();
  double next_y = crossing_y();
  while (left_x > 0 || left_y > 0) {
    // Rounding may put a crossing a hair outside [t, 1].
    const double next = std::min(1.0, std::max(t, std::min(next_x, next_y)));
    if (!call(cell, (next - t) * length_m)) return;
    t = next;
    const bool cross_x = next_x <= next_y;
    const bool cross_y = next_y <= next_x;
    if (cross_x) {
      cell.x += step_x;
      --left_x;
      next_x = crossing_x();
    }
    if (cross_y) {
      cell.y += step_y;
      --left_y;
      next_y = crossing_y();
    }
  }
  call(cell, (1.0 - t) * length_m);
}

}  // namespace strata
