// SPDX-License-Identifier: Apache-2.0
/// Exact traversal of a segment through the cells it crosses, with the length inside each.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <type_traits>

#include "core/grid/grid.hpp"
#include "core/grid/ray_columns.hpp"

namespace strata {
namespace detail {

/// Where a traversal is: as a cell, or as a place in a grid.
struct CellCursor {
  Cell at;
  Cell major;  ///< what a step along the longer axis adds
  Cell minor;
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

/// The lines that a segment crosses, and how its cells lie.
struct RayCourse {
  RayLines lines;
  Cell first;
  bool is_steep = false;  ///< the longer axis is y

  RayCourse(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double resolution_m)
      : first(cell_at(from_m, resolution_m)) {
    const double scale = 1.0 / resolution_m;
    const Cell last = cell_at(to_m, resolution_m);
    const double dx = to_m.x() - from_m.x();
    const double dy = to_m.y() - from_m.y();
    is_steep = std::abs(dy) > std::abs(dx);
    const double da = is_steep ? dy : dx;
    const double db = is_steep ? dx : dy;
    const int first_a = is_steep ? first.y : first.x;
    const int first_b = is_steep ? first.x : first.y;
    lines.length_m = std::sqrt(dx * dx + dy * dy);
    // In units of cells, so that lattice lines are whole numbers.
    lines.start_a = (is_steep ? from_m.y() : from_m.x()) * scale;
    lines.start_b = (is_steep ? from_m.x() : from_m.y()) * scale;
    lines.left_a = std::abs((is_steep ? last.y : last.x) - first_a);
    lines.left_b = std::abs((is_steep ? last.x : last.y) - first_b);
    lines.step_a = da > 0.0 ? 1.0 : -1.0;
    lines.step_b = db > 0.0 ? 1.0 : -1.0;
    lines.inverse_a = lines.left_a > 0 ? 1.0 / (da * scale) : 0.0;
    lines.inverse_b = lines.left_b > 0 ? 1.0 / (db * scale) : 0.0;
    lines.line_a = first_a + (da > 0.0 ? 1 : 0);
    lines.line_b = first_b + (db > 0.0 ? 1 : 0);
    lines.along_b = db * scale;
  }
  [[nodiscard]] Cell major() const {
    const int step = lines.step_a > 0.0 ? 1 : -1;
    return is_steep ? Cell{0, step} : Cell{step, 0};
  }
  [[nodiscard]] Cell minor() const {
    const int step = lines.step_b > 0.0 ? 1 : -1;
    return is_steep ? Cell{step, 0} : Cell{0, step};
  }
};

/// One cell after the other, from t of the ray on. The loop runs over the lines that cross the
/// longer axis, so that it branches on what varies least.
template <typename Cursor, typename Visit>
void walk_lines(const RayLines& lines, Cursor cursor, double t, Visit&& visit) {
  int left_a = lines.left_a;
  int left_b = lines.left_b;
  double line_a = lines.line_a;
  double line_b = lines.line_b;
  // Rounding may put a crossing a hair outside [t, 1].
  auto visit_until = [&](double crossing) {
    const double next = std::max(t, std::min(1.0, crossing));
    const double inside_m = (next - t) * lines.length_m;
    t = next;
    if constexpr (std::is_same_v<decltype(visit(cursor.at, inside_m)), bool>) {
      return visit(cursor.at, inside_m);
    } else {
      visit(cursor.at, inside_m);
      return true;
    }
  };
  constexpr double kNever = std::numeric_limits<double>::infinity();
  auto crossing_b = [&] {
    return left_b > 0 ? (line_b - lines.start_b) * lines.inverse_b : kNever;
  };
  auto cross_b = [&] {
    cursor.go_minor();
    line_b += lines.step_b;
    --left_b;
  };
  double next_b = crossing_b();
  for (; left_a > 0; --left_a) {
    const double next_a = (line_a - lines.start_a) * lines.inverse_a;
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
    line_a += lines.step_a;
  }
  while (left_b > 0) {
    if (!visit_until(next_b)) return;
    cross_b();
    next_b = crossing_b();
  }
  visit_until(1.0);
}

/// Rays with fewer lines to cross are not worth the preparation.
constexpr int kMinColumns = 20;

/// The same cells and lengths as walk_lines, to the last bit.
template <typename Visit>
void walk_columns(const RayLines& lines, const IndexCursor& start, Visit&& visit) {
  RayColumns ray;
  ray.lines = lines;
  ray.first = static_cast<double>(start.at);
  ray.major = static_cast<double>(static_cast<std::ptrdiff_t>(start.major));
  ray.minor = static_cast<double>(static_cast<std::ptrdiff_t>(start.minor));
  RayCells cells;
  while (const std::size_t count = next_cells(ray, cells)) {
    for (std::size_t k = 0; k < count; ++k) {
      const RayCell& cell = cells.cell[k];
      visit(static_cast<std::size_t>(std::bit_cast<std::uint64_t>(cell.number)), cell.length_m);
    }
  }
  if (ray.column > lines.left_a) return;
  RayLines rest = lines;
  rest.left_a -= ray.column;
  rest.left_b -= ray.crossed_b;
  rest.line_a += ray.column * lines.step_a;
  rest.line_b += ray.crossed_b * lines.step_b;
  const std::size_t at = start.at + static_cast<std::size_t>(ray.column) * start.major +
                         static_cast<std::size_t>(ray.crossed_b) * start.minor;
  walk_lines(rest, IndexCursor{at, start.major, start.minor}, ray.t, visit);
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
  const detail::RayCourse course(from_m, to_m, resolution_m);
  detail::walk_lines(course.lines, detail::CellCursor{course.first, course.major(), course.minor()},
                     0.0, visit);
}

/// The same with visit(std::size_t index, double length_m), the cell's place in grid.values().
/// Where `visit` returns nothing, many cells are found at once. Requires both end cells in the
/// grid.
template <typename T, typename Visit>
void traverse_ray(const Grid<T>& grid, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                  Visit&& visit) {
  const detail::RayCourse course(from_m, to_m, grid.resolution_m());
  const auto stride = [&](const Cell& step) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(step.y) * grid.width() + step.x);
  };
  const detail::IndexCursor cursor{grid.index(course.first), stride(course.major()),
                                   stride(course.minor())};
  if constexpr (std::is_void_v<decltype(visit(cursor.at, 0.0))>) {
    // A ray that is parallel to an axis but for a rounding has no finite inverse.
    if (course.lines.left_a >= detail::kMinColumns && std::isfinite(course.lines.inverse_b)) {
      detail::walk_columns(course.lines, cursor, visit);
      return;
    }
  }
  detail::walk_lines(course.lines, cursor, 0.0, visit);
}

}  // namespace strata
