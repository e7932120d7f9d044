// SPDX-License-Identifier: Apache-2.0
#include "core/plan/face_field.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace strata::plan {

FaceField::FaceField(std::vector<WallFace> faces, double cell_m, double radius_m)
    : faces_(std::move(faces)) {
  const int reach = static_cast<int>(std::ceil(radius_m / cell_m));
  CellRect rect;
  for (const WallFace& face : faces_) {
    const Cell cell = cell_at(face.at_m, cell_m);
    rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  }
  if (!rect.empty()) rect = rect.inflated(reach);
  Grid<float> squared_m2(cell_m, rect);
  for (int direction = 0; direction < kDirections; ++direction) {
    Grid<std::int32_t>& nearest = nearest_[static_cast<std::size_t>(direction)];
    nearest = Grid<std::int32_t>(cell_m, rect, -1);
    squared_m2 = Grid<float>(cell_m, rect, static_cast<float>(radius_m * radius_m));
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const int apart = (direction_of(faces_[i].normal) - direction + kDirections) % kDirections;
      if (apart > 1 && apart < kDirections - 1) continue;
      const Cell middle = cell_at(faces_[i].at_m, cell_m);
      for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
        for (int x = middle.x - reach; x <= middle.x + reach; ++x) {
          const std::size_t at = nearest.index({x, y});
          const auto squared =
              static_cast<float>((cell_center({x, y}, cell_m) - faces_[i].at_m).squaredNorm());
          if (squared >= squared_m2.values()[at]) continue;
          squared_m2.values()[at] = squared;
          nearest.values()[at] = static_cast<std::int32_t>(i);
        }
      }
    }
  }
}

const WallFace* FaceField::nearest(const Eigen::Vector2d& at_m,
                                   const Eigen::Vector2d& normal) const {
  const Grid<std::int32_t>& grid = nearest_[static_cast<std::size_t>(direction_of(normal))];
  const std::int32_t index = grid.get(grid.cell_at(at_m));
  return index < 0 ? nullptr : &faces_[static_cast<std::size_t>(index)];
}

}  // namespace strata::plan
