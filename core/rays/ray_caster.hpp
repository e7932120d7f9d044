// SPDX-License-Identifier: Apache-2.0
/// How far a beam goes in a grid: exact cell by cell near obstacles, in skips of empty space where
/// a distance field says that there are none.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/geometry/pose2.hpp"
#include "core/grid/distance_field.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/rays/ray_kernel.hpp"

namespace strata::rays {

/// Walks rays through a set of marked cells. After the distance to the nearest marked cell centre
/// at a cell's centre, less one cell diagonal, every skip is safe: it never enters a marked cell,
/// so the walk visits exactly the marked cells that the exact traversal visits.
class RayWalker {
 public:
  RayWalker() = default;
  explicit RayWalker(const Grid<std::uint8_t>& marked);
  /// Cells with a mark above 0 are marked. Requires marks below 2^24.
  explicit RayWalker(const Grid<std::int32_t>& marks);

  [[nodiscard]] const CellRect& rect() const { return empty_skip_.rect(); }
  [[nodiscard]] double resolution_m() const { return empty_skip_.resolution_m(); }

  /// The mark of a cell by its number; 0: none. 1 where marks were not given.
  [[nodiscard]] std::int32_t mark(std::size_t index) const {
    const float empty_skip = empty_skip_.values()[index];
    return empty_skip < 0.0F ? static_cast<std::int32_t>(-empty_skip) : 0;
  }

  /// Whether the nearest marked cell's centre is within `distance_m` of the centre of the cell that
  /// a point lies in; distances up to a cell's diagonal are as good as it. Outside rect() the way
  /// to its edge is added, which is the distance at most.
  [[nodiscard]] bool is_near(const Eigen::Vector2d& point_m, double distance_m) const {
    const CellRect& rect = empty_skip_.rect();
    if (rect.area() == 0) return false;
    const Cell cell = empty_skip_.cell_at(point_m);
    const Cell inside{std::clamp(cell.x, rect.min.x, rect.max.x - 1),
                      std::clamp(cell.y, rect.min.y, rect.max.y - 1)};
    const double empty_skip = static_cast<double>(empty_skip_.at(inside));
    const double way = std::hypot(cell.x - inside.x, cell.y - inside.y);
    const double away = empty_skip <= 0.0 ? 0.0 : empty_skip + std::numbers::sqrt2;
    return (away + way) * empty_skip_.resolution_m() <= distance_m + kRounding_m;
  }

  /// The same for kernels.
  [[nodiscard]] RayTable table() const {
    return {empty_skip_.values().data(),
            empty_skip_.width(),
            empty_skip_.height(),
            static_cast<double>(rect().min.x),
            static_cast<double>(rect().min.y),
            resolution_m()};
  }

  /// Calls visit(index of the cell in the grid, entry_m, exit_m) for each marked cell on the ray,
  /// in order, until it returns false, the ray is max_range_m long, or leaves the grid. Rays that
  /// start outside the grid are cut to it. A cell that the ray starts in counts. No allocation.
  /// Requires finite numbers. c, s: cosine and sine of the direction.
  template <typename Visit>
  void walk(double x_m, double y_m, double c, double s, double max_range_m, Visit&& visit) const;

 private:
  /// Cuts [t0, t1] to where start + t * direction lies in [low, high].
  static void clip(double start, double direction, double low, double high, double& t0,
                   double& t1) {
    if (direction == 0.0) {
      if (start < low || start >= high) t1 = -1.0;
      return;
    }
    const double a = (low - start) / direction;
    const double b = (high - start) / direction;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }

  static constexpr double kRounding_m = 1e-4;
  Grid<float> empty_skip_;  ///< cells that a ray may skip from anywhere in this cell; < 0: -mark
};

template <typename Visit>
void RayWalker::walk(double x_m, double y_m, double c, double s, double max_range_m,
                     Visit&& visit) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double resolution = empty_skip_.resolution_m();
  const CellRect& rect = empty_skip_.rect();
  const int width = rect.width();
  const int height = rect.height();
  // All in cells, relative to the grid's corner.
  const double x = x_m / resolution - rect.min.x;
  const double y = y_m / resolution - rect.min.y;
  double t = 0.0;
  double end = max_range_m / resolution;
  if (!(x >= 0.0 && x < width && y >= 0.0 && y < height)) {
    clip(x, c, 0.0, width, t, end);
    clip(y, s, 0.0, height, t, end);
  }
  if (!(t < end)) return;
  const double inverse_c = c != 0.0 ? 1.0 / c : 0.0;
  const double inverse_s = s != 0.0 ? 1.0 / s : 0.0;
  const int step_x = c > 0.0 ? 1 : -1;
  const int step_y = s > 0.0 ? 1 : -1;
  const int line_x = c > 0.0 ? 1 : 0;
  const int line_y = s > 0.0 ? 1 : 0;
  int i = std::clamp(static_cast<int>(x + t * c), 0, width - 1);
  int j = std::clamp(static_cast<int>(y + t * s), 0, height - 1);
  const float* const empty_skips = empty_skip_.values().data();
  while (t < end) {
    const std::size_t index =
        static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i);
    const auto empty_skip = static_cast<double>(empty_skips[index]);
    if (empty_skip > 1.0) {
      t += empty_skip;
      const double u = x + t * c;
      const double v = y + t * s;
      // Truncation is floor from here on, and needs no library call.
      if (u < 0.0 || v < 0.0) return;
      i = static_cast<int>(u);
      j = static_cast<int>(v);
    } else {
      const double next_x = c != 0.0 ? (i + line_x - x) * inverse_c : kNever;
      const double next_y = s != 0.0 ? (j + line_y - y) * inverse_s : kNever;
      // Rounding may put a line a hair behind.
      const double next = std::max(t, std::min(next_x, next_y));
      if (empty_skip < 0.0 && !visit(index, t * resolution, std::min(next, end) * resolution)) {
        return;
      }
      t = next;
      if (next_x <= next_y) i += step_x;
      if (next_y <= next_x) j += step_y;
    }
    if (i < 0 || j < 0 || i >= width || j >= height) return;
  }
}

/// Expected ranges in one map: to the middle of the ray's way through the first occupied cell
/// (is_occupied), as a surface lies anywhere in its cell. Unknown cells are transparent.
class RayCaster {
 public:
  RayCaster() = default;
  /// max_range_m: obstacles further away are not looked for.
  explicit RayCaster(const ReflectionGrid& map, double max_range_m = 100.0);

  /// Metres along the beam, or +infinity when it meets nothing within the limit. 20 to 100 ns.
  [[nodiscard]] double expected_range_m(const Pose2& map_from_laser, double bearing_rad) const;
  /// The same for many beams at once: those of `bundle`, no further than its limit and this one's.
  /// range_m, cell: bundle.count places; cell is rubbish to the caller.
  void expected_ranges_m(const BeamBundle& bundle, double* range_m, std::int32_t* cell) const {
    BeamBundle limited = bundle;
    limited.max_range_m = std::min(bundle.max_range_m, max_range_m_);
    cast_rays(walker_.table(), limited, range_m, cell);
  }
  /// For kernels that cast many beams from many places, no further than max_range_m.
  [[nodiscard]] RayTable table() const { return walker_.table(); }
  [[nodiscard]] double max_range_m() const { return max_range_m_; }
  /// The same for a direction given by its cosine and sine.
  [[nodiscard]] double range_m(double x_m, double y_m, double c, double s,
                               double max_range_m) const {
    double range = std::numeric_limits<double>::infinity();
    walker_.walk(x_m, y_m, c, s, max_range_m,
                 [&range](std::size_t /*cell*/, double entry_m, double exit_m) {
                   range = 0.5 * (entry_m + exit_m);
                   return false;
                 });
    return range;
  }
  /// Whether the map says anything of the cell that a point lies in.
  [[nodiscard]] bool knows(const Eigen::Vector2d& point_m) const {
    return known_.get(known_.cell_at(point_m)) != 0;
  }
  /// Whether an obstacle lies within `distance_m` of a point of the map; see RayWalker.
  [[nodiscard]] bool is_near_surface(const Eigen::Vector2d& point_m, double distance_m) const {
    return walker_.is_near(point_m, distance_m);
  }

 private:
  RayWalker walker_;
  Grid<std::uint8_t> known_;
  double max_range_m_ = 0.0;
};

}  // namespace strata::rays
