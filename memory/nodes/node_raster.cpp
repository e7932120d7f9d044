// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

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
  void paint(const Cell& cell, double distance_m, bool occupied) {
    if (!grid_.contains(cell)) return;
    float& nearest = distance_m_.at(cell);
    const auto distance = static_cast<float>(distance_m);
    if (occupied ? distance > nearest : distance >= nearest) return;
    nearest = distance;
    grid_.at(cell) = occupied ? 1.0F : 0.0F;
  }
  [[nodiscard]] ReflectionGrid take() && { return std::move(grid_); }

 private:
  ReflectionGrid grid_;
  Grid<float> distance_m_;
};

void paint_node(const NodeOutline& outline, const Eigen::Vector2d& node_m, double max_range_m,
                double resolution_m, Raster& raster) {
  const int reach = static_cast<int>(std::ceil(max_range_m / resolution_m)) + 1;
  const Cell middle = cell_at(node_m, resolution_m);
  for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
    for (int x = middle.x - reach; x <= middle.x + reach; ++x) {
      const Eigen::Vector2d offset = cell_center({x, y}, resolution_m) - node_m;
      if (offset.squaredNorm() > max_range_m * max_range_m) continue;
      if (outline.contains(offset)) raster.paint({x, y}, offset.norm(), false);
    }
  }
  for (std::size_t a = 0; a < outline.size(); ++a) {
    if (outline.edge(a) != NodeOutline::Edge::kSurface) continue;
    const std::size_t b = a + 1 == outline.size() ? 0 : a + 1;
    traverse_ray(node_m + outline.corner_m(a), node_m + outline.corner_m(b), resolution_m,
                 [&](const Cell& cell, double /*length_m*/) {
                   const double distance_m = (cell_center(cell, resolution_m) - node_m).norm();
                   raster.paint(cell, distance_m, true);
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
