// SPDX-License-Identifier: Apache-2.0
/// Dense 2-D grids on one lattice of the map frame.
///
/// Cell (i, j) covers [i*res, (i+1)*res) x [j*res, (j+1)*res), so its index is floor(x/res): grids
/// of one resolution are aligned whatever part of the plane they cover, and growing one moves
/// nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace strata {

/// Integer coordinates of a cell on the lattice; may be negative.
struct Cell {
  int x = 0;
  int y = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
  friend auto operator<=>(const Cell&, const Cell&) = default;
};

/// The lattice coordinate that x_m falls into: floor(x_m / resolution_m).
[[nodiscard]] inline int cell_coordinate(double x_m, double resolution_m) {
  return static_cast<int>(std::floor(x_m / resolution_m));
}
[[nodiscard]] inline Cell cell_at(const Eigen::Vector2d& point_m, double resolution_m) {
  return {cell_coordinate(point_m.x(), resolution_m), cell_coordinate(point_m.y(), resolution_m)};
}
[[nodiscard]] inline Eigen::Vector2d cell_center(const Cell& cell, double resolution_m) {
  return {(cell.x + 0.5) * resolution_m, (cell.y + 0.5) * resolution_m};
}

/// Whether holds(Cell) for a cell or one of the eight around it.
template <typename Holds>
[[nodiscard]] bool any_beside(const Cell& cell, const Holds& holds) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (holds(Cell{cell.x + dx, cell.y + dy})) return true;
    }
  }
  return false;
}

/// A half-open rectangle of cells: min.x <= x < max.x. Empty when a side is not positive.
struct CellRect {
  Cell min;
  Cell max;
  friend bool operator==(const CellRect&, const CellRect&) = default;

  [[nodiscard]] int width() const { return std::max(0, max.x - min.x); }
  [[nodiscard]] int height() const { return std::max(0, max.y - min.y); }
  [[nodiscard]] std::size_t area() const {
    return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
  [[nodiscard]] bool empty() const { return area() == 0; }
  [[nodiscard]] bool contains(const Cell& cell) const {
    return cell.x >= min.x && cell.x < max.x && cell.y >= min.y && cell.y < max.y;
  }
  /// Grown by `cells` on each side.
  [[nodiscard]] CellRect inflated(int cells) const {
    return {{min.x - cells, min.y - cells}, {max.x + cells, max.y + cells}};
  }
  /// The smallest rectangle that holds both; an empty one adds nothing.
  [[nodiscard]] CellRect united(const CellRect& other) const {
    if (empty()) return other;
    if (other.empty()) return *this;
    return {{std::min(min.x, other.min.x), std::min(min.y, other.min.y)},
            {std::max(max.x, other.max.x), std::max(max.y, other.max.y)}};
  }
  [[nodiscard]] CellRect intersected(const CellRect& other) const {
    return {{std::max(min.x, other.min.x), std::max(min.y, other.min.y)},
            {std::min(max.x, other.max.x), std::min(max.y, other.max.y)}};
  }
};

/// A rectangle that covers `rect` and `needed`, with 64 cells to spare on the sides that grow, so
/// that a robot that drives on rarely makes its map grow; `rect` where it holds `needed`.
[[nodiscard]] inline CellRect grown(const CellRect& rect, const CellRect& needed) {
  const CellRect united = rect.united(needed);
  if (united == rect) return rect;
  const int spare = 64;
  CellRect target = united;
  if (united.min.x < rect.min.x || rect.empty()) target.min.x -= spare;
  if (united.min.y < rect.min.y || rect.empty()) target.min.y -= spare;
  if (united.max.x > rect.max.x || rect.empty()) target.max.x += spare;
  if (united.max.y > rect.max.y || rect.empty()) target.max.y += spare;
  return target;
}

/// Values of type T on a rectangle of cells, row by row in y, x fastest.
template <typename T>
class Grid {
 public:
  Grid() = default;
  Grid(double resolution_m, CellRect rect, const T& fill = T())
      : resolution_m_(resolution_m), rect_(rect), fill_(fill), values_(rect.area(), fill) {}

  [[nodiscard]] double resolution_m() const { return resolution_m_; }
  [[nodiscard]] const CellRect& rect() const { return rect_; }
  [[nodiscard]] int width() const { return rect_.width(); }
  [[nodiscard]] int height() const { return rect_.height(); }
  [[nodiscard]] bool contains(const Cell& cell) const { return rect_.contains(cell); }
  [[nodiscard]] std::size_t size() const { return values_.size(); }

  /// Place in `values()`. Requires contains(cell).
  [[nodiscard]] std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>(cell.y - rect_.min.y) *
               static_cast<std::size_t>(rect_.width()) +
           static_cast<std::size_t>(cell.x - rect_.min.x);
  }
  [[nodiscard]] Cell cell(std::size_t index) const {
    const auto width = static_cast<std::size_t>(rect_.width());
    return {rect_.min.x + static_cast<int>(index % width),
            rect_.min.y + static_cast<int>(index / width)};
  }
  /// Requires contains(cell).
  [[nodiscard]] T& at(const Cell& cell) { return values_[index(cell)]; }
  [[nodiscard]] const T& at(const Cell& cell) const { return values_[index(cell)]; }
  /// The value, or the fill value outside.
  [[nodiscard]] const T& get(const Cell& cell) const {
    return contains(cell) ? values_[index(cell)] : fill_;
  }
  [[nodiscard]] Cell cell_at(const Eigen::Vector2d& point_m) const {
    return strata::cell_at(point_m, resolution_m_);
  }
  [[nodiscard]] Eigen::Vector2d center(const Cell& cell) const {
    return cell_center(cell, resolution_m_);
  }

  [[nodiscard]] std::vector<T>& values() { return values_; }
  [[nodiscard]] const std::vector<T>& values() const { return values_; }
  [[nodiscard]] const T& fill() const { return fill_; }

  /// Makes the grid cover `needed` too, with cells to spare (see `grown`); new cells get the fill
  /// value. O(area) when it grows.
  void grow(const CellRect& needed) {
    const CellRect target = grown(rect_, needed);
    if (target != rect_) *this = cropped(target);
  }

  /// The same values on another rectangle; the fill value where this grid has none.
  [[nodiscard]] Grid cropped(const CellRect& rect) const {
    Grid result(resolution_m_, rect, fill_);
    const CellRect common = rect_.intersected(rect);
    for (int y = common.min.y; y < common.max.y && !common.empty(); ++y) {
      const auto from = values_.begin() + static_cast<std::ptrdiff_t>(index({common.min.x, y}));
      std::copy(
          from, from + common.width(),
          result.values_.begin() + static_cast<std::ptrdiff_t>(result.index({common.min.x, y})));
    }
    return result;
  }

 private:
  double resolution_m_ = 0.05;
  CellRect rect_;
  T fill_{};
  std::vector<T> values_;
};

}  // namespace strata
