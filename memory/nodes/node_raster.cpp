// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/grid/ray_traversal.hpp"
#include "memory/nodes/node_map.hpp"

namespace strata::memory {
namespace {

/// A picture where, per cell, the nearest node that says something has its way.
class Raster {
 public:
  Raster(double resolution_m, const CellRect& rect)
      : grid_(make_reflection_grid(resolution_m, rect)),
        distance_m_(resolution_m, rect, std::numeric_limits<float>::infinity()) {}

  /// Surfaces of one node come after its free space, and win over it.
  [[nodiscard]] bool takes(const Cell& cell, double distance_m, bool occupied) const {
    if (!grid_.contains(cell)) return false;
    const float nearest = distance_m_.at(cell);
    const auto distance = static_cast<float>(distance_m);
    return occupied ? distance <= nearest : distance < nearest;
  }
  /// Requires that it takes this.
  void paint(const Cell& cell, double distance_m, bool occupied) {
    distance_m_.at(cell) = static_cast<float>(distance_m);
    grid_.at(cell) = occupied ? 1.0F : 0.0F;
  }
  [[nodiscard]] ReflectionGrid take() && { return std::move(grid_); }

 private:
  ReflectionGrid grid_;
  Grid<float> distance_m_;
};

/// Where the outline crosses the rows of cells, at the height of their centres.
class Crossings {
 public:
  Crossings(const NodeOutline& outline, const Eigen::Vector2d& node_m, double resolution_m)
      : resolution_m_(resolution_m) {
    double lowest_m = node_m.y();
    double highest_m = node_m.y();
    for (std::size_t a = 0; a < outline.size(); ++a) {
      lowest_m = std::min(lowest_m, node_m.y() + outline.corner_m(a).y());
      highest_m = std::max(highest_m, node_m.y() + outline.corner_m(a).y());
    }
    first_row_ = row_above(lowest_m);
    x_m_.resize(static_cast<std::size_t>(std::max(0, row_above(highest_m) - first_row_)));
    for (std::size_t a = 0; a < outline.size(); ++a) {
      const std::size_t b = a + 1 == outline.size() ? 0 : a + 1;
      add(node_m + outline.corner_m(a), node_m + outline.corner_m(b));
    }
    for (std::vector<double>& row : x_m_) std::sort(row.begin(), row.end());
  }

  /// Calls visit(cell) for every cell whose centre is inside.
  template <typename Visit>
  void visit_inside(const Visit& visit) const {
    for (std::size_t r = 0; r < x_m_.size(); ++r) {
      const std::vector<double>& row = x_m_[r];
      for (std::size_t i = 0; i + 1 < row.size(); i += 2) {
        const int end = row_above(row[i + 1]);  // columns lie as rows do
        for (int x = row_above(row[i]); x < end; ++x) visit({x, first_row_ + static_cast<int>(r)});
      }
    }
  }

 private:
  /// The first row whose centre is at this height or above.
  [[nodiscard]] int row_above(double y_m) const {
    return static_cast<int>(std::ceil(y_m / resolution_m_ - 0.5));
  }
  void add(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    const Eigen::Vector2d& low = from_m.y() < to_m.y() ? from_m : to_m;
    const Eigen::Vector2d& high = from_m.y() < to_m.y() ? to_m : from_m;
    for (int y = row_above(low.y()); y < row_above(high.y()); ++y) {
      const double share =
          (cell_center({0, y}, resolution_m_).y() - low.y()) / (high.y() - low.y());
      x_m_[static_cast<std::size_t>(y - first_row_)].push_back(low.x() +
                                                               share * (high.x() - low.x()));
    }
  }

  double resolution_m_;
  int first_row_ = 0;
  std::vector<std::vector<double>> x_m_;  ///< by row
};

void paint_node(const NodeOutline& outline, const Eigen::Vector2d& node_m, double max_range_m,
                double resolution_m, Raster& raster) {
  Crossings(outline, node_m, resolution_m).visit_inside([&](const Cell& cell) {
    const double distance_m = (cell_center(cell, resolution_m) - node_m).norm();
    if (distance_m > max_range_m || !raster.takes(cell, distance_m, false)) return;
    raster.paint(cell, distance_m, false);
  });
  for (std::size_t a = 0; a < outline.size(); ++a) {
    if (outline.edge(a) != NodeOutline::Edge::kSurface) continue;
    const std::size_t b = a + 1 == outline.size() ? 0 : a + 1;
    traverse_ray(node_m + outline.corner_m(a), node_m + outline.corner_m(b), resolution_m,
                 [&](const Cell& cell, double /*length_m*/) {
                   const double distance_m = (cell_center(cell, resolution_m) - node_m).norm();
                   if (raster.takes(cell, distance_m, true)) raster.paint(cell, distance_m, true);
                 });
  }
}

}  // namespace

ReflectionGrid NodeMap::level_map(int level, double resolution_m) const {
  CellRect rect;
  const int reach = static_cast<int>(std::ceil(bins_.max_range_m / resolution_m)) + 1;
  for (const Node& node : nodes_) {
    const Cell cell = cell_at(node.position_m, resolution_m);
    rect = rect.united(CellRect{cell, {cell.x + 1, cell.y + 1}}.inflated(reach));
  }
  Raster raster(resolution_m, rect);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    paint_node(this->level(level, static_cast<int>(n)).outline, nodes_[n].position_m,
               bins_.max_range_m, resolution_m, raster);
  }
  return std::move(raster).take();
}

}  // namespace strata::memory
