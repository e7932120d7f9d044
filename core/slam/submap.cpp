// SPDX-License-Identifier: Apache-2.0
#include "core/slam/submap.hpp"

#include <cmath>

namespace strata::slam {

Submap make_submap(const SurfaceMap& map, int run, const Pose2& run_from_submap,
                   std::size_t first_scan, std::size_t last_scan) {
  Submap submap;
  submap.run = run;
  submap.first_scan = first_scan;
  submap.last_scan = last_scan;
  submap.run_from_submap = run_from_submap;
  const Pose2 submap_from_run = inverse(run_from_submap);
  const Pose2 turn{0.0, 0.0, submap_from_run.theta};
  const double resolution = map.field().resolution_m();
  CellRect rect;
  for (const registration::SurfacePoint& point : map.field().points()) {
    if (!point.occupied) continue;
    registration::SurfacePoint moved = point;
    const Eigen::Vector2d at = submap_from_run * Eigen::Vector2d(point.x_m, point.y_m);
    const Eigen::Vector2d normal = turn * Eigen::Vector2d(point.normal_x, point.normal_y);
    moved.x_m = at.x();
    moved.y_m = at.y();
    moved.normal_x = normal.x();
    moved.normal_y = normal.y();
    submap.points.push_back(moved);
    submap.center_m += at;
    const Cell cell = cell_at(at, resolution);
    rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  }
  if (submap.points.empty()) return submap;
  submap.center_m /= static_cast<double>(submap.points.size());
  submap.states = StateGrid(resolution, rect.inflated(2), SurfaceState::kUnknown);
  for (std::size_t i = 0; i < submap.states.size(); ++i) {
    const Eigen::Vector2d center = submap.states.center(submap.states.cell(i));
    submap.states.values()[i] = map.state(run_from_submap * center);
  }
  return submap;
}

}  // namespace strata::slam
