// SPDX-License-Identifier: Apache-2.0
/// Exact traversal of a segment through the cells it crosses, with the length inside each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "core/grid/grid.hpp"

namespace strata {
namespace detail {

/// Where a traversal is: as a cell, or as a place in a grid.
struct CellCursor {
  Cell at;
  Cell major;  ///< what a step along the longer axis adds
  Cell minor;
  CellCursor(const Cell& first, bool is_steep, int step_major, int step_minor)
      : at(first),
        major(is_steep ? Cell{0, step_major} : Cell{step_major, 0}),
        minor(is_steep ? Cell{step_minor, 0} : Cell{0, step_minor}) {}
  void go_major() { at = {at.x + major.x, at.y + major.y}; }
  void go_minor() { at = {at.x + minor.x, at.y + minor.y}; }
};
struct IndexCursor {
  std::size_t at;
  std::size_t major;  ///< wraps around for steps back
  std::size_t minor;
  void go_major() { at += major; }
  void go_minor() { at += minor; }
};

/// make(first cell, is_steep, step along the longer axis, along the other) gives the cursor. The
/// loop runs over the lines that cross the longer axis, so that it branches on what varies least.
template <typename Make, typename Visit>
void traverse(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double resolution_m,
              Make&& make, Visit&& visit) {
  const double scale = 1.0 / resolution_m;
  const Cell first = cell_at(from_m, resolution_m);
  const Cell last = cell_at(to_m, resolution_m);
  const double dx = to_m.x() - from_m.x();
  const double dy = to_m.y() - from_m.y();
  const double length_m = std::sqrt(dx * dx + dy * dy);
  const bool is_steep = std::abs(dy) > std::abs(dx);
  // a: the longer axis, b: the other. In units of cells, so that lattice lines are whole numbers.
  const double da = is_steep ? dy : dx;
  const double db = is_steep ? dx : dy;
  const double start_a = (is_steep ? from_m.y() : from_m.x()) * scale;
  const double start_b = (is_steep ? from_m.x() : from_m.y()) * scale;
  const int first_a = is_steep ? first.y : first.x;
  const int first_b = is_steep ? first.x : first.y;
  int left_a = std::abs((is_steep ? last.y : last.x) - first_a);
  int left_b = std::abs((is_steep ? last.x : last.y) - first_b);
  const double step_a = da > 0.0 ? 1.0 : -1.0;
  const double step_b = db > 0.0 ? 1.0 : -1.0;
  const double inverse_a = left_a > 0 ? 1.0 / (da * scale) : 0.0;
  const double inverse_b = left_b > 0 ? 1.0 / (db * scale) : 0.0;
  double line_a = first_a + (da > 0.0 ? 1 : 0);
  double line_b = first_b + (db > 0.0 ? 1 : 0);
  auto cursor = make(first, is_steep, da > 0.0 ? 1 : -1, db > 0.0 ? 1 : -1);
  double t = 0.0;
  // Rounding may put a crossing a hair outside [t, 1].
  auto visit_until = [&](double crossing) {
    const double next = std::max(t, std::min(1.0, crossing));
    const double inside_m = (next - t) * length_m;
    t = next;
    if constexpr (std::is_same_v<decltype(visit(cursor.at, inside_m)), bool>) {
      return visit(cursor.at, inside_m);
    } else {
      visit(cursor.at, inside_m);
      return true;
    }
  };
  constexpr double kNever = std::numeric_limits<double>::infinity();
  auto crossing_b = [&] { return left_b > 0 ? (line_b - start_b) * inverse_b : kNever; };
  auto cross_b = [&] {
    cursor.go_minor();
    line_b += step_b;
    --left_b;
  };
  double next_b = crossing_b();
  for (; left_a > 0; --left_a) {
    const double next_a = (line_a - start_a) * inverse_a;
    while (next_b < next_a) {
      if (!visit_until(next_b)) return;
      cross_b();
      next_b = crossing_b();
    }
    if (!visit_until(next_a)) return;
    if (next_b == next_a) {
      cross_b();
      next_b = crossing_b();
    }
    cursor.go_major();
    line_a += step_a;
  }
  while (left_b > 0) {
    if (!visit_until(next_b)) return;
    cross_b();
    next_b = crossing_b();
  }
  visit_until(1.0);
}

}  // namespace detail

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
  detail::traverse(
      from_m, to_m, resolution_m,
      [](const Cell& first, bool is_steep, int step_major, int step_minor) {
        return detail::CellCursor(first, is_steep, step_major, step_minor);
      },
      visit);
}

/// The same with visit(std::size_t index, double length_m), the cell's place in grid.values().
/// Requires both end cells in the grid.
template <typename T, typename Visit>
void traverse_ray(const Grid<T>& grid, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                  Visit&& visit) {
  const auto width = static_cast<std::ptrdiff_t>(grid.width());
  detail::traverse(
      from_m, to_m, grid.resolution_m(),
      [&](const Cell& first, bool is_steep, int step_major, int step_minor) {
        const auto major = static_cast<std::size_t>(is_steep ? step_major * width : step_major);
        const auto minor = static_cast<std::size_t>(is_steep ? step_minor : step_minor * width);
        return detail::IndexCursor{grid.index(first), major, minor};
      },
      visit);
}

}  // namespace strata
