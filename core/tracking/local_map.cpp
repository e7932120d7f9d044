// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/local_map.hpp"

#include <cmath>

namespace strata::slam {

LocalMap make_local_map(const SurfaceMap& map, int run, const Pose2& run_from_local_map,
                        std::size_t first_scan, std::size_t last_scan) {
  LocalMap local_map;
  local_map.run = run;
  local_map.first_scan = first_scan;
  local_map.last_scan = last_scan;
  local_map.run_from_local_map = run_from_local_map;
  const Pose2 local_map_from_run = inverse(run_from_local_map);
  const Pose2 turn{0.0, 0.0, local_map_from_run.theta};
  const double resolution = map.field().resolution_m();
  CellRect rect;
  for (const registration::SurfacePoint& point : map.field().points()) {
    if (!point.occupied) continue;
    registration::SurfacePoint moved = point;
    const Eigen::Vector2d at = local_map_from_run * Eigen::Vector2d(point.x_m, point.y_m);
    const Eigen::Vector2d normal = turn * Eigen::Vector2d(point.normal_x, point.normal_y);
    moved.x_m = at.x();
    moved.y_m = at.y();
    moved.normal_x = normal.x();
    moved.normal_y = normal.y();
    local_map.points.push_back(moved);
    local_map.center_m += at;
    const Cell cell = cell_at(at, resolution);
    rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  }
  if (local_map.points.empty()) return local_map;
  local_map.center_m /= static_cast<double>(local_map.points.size());
  local_map.states = StateGrid(resolution, rect.inflated(2), SurfaceState::kUnknown);
  for (std::size_t i = 0; i < local_map.states.size(); ++i) {
    const Eigen::Vector2d center = local_map.states.center(local_map.states.cell(i));
    local_map.states.values()[i] = map.state(run_from_local_map * center);
  }
  return local_map;
}

}  // namespace strata::slam
