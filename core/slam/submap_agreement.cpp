// SPDX-License-Identifier: Apache-2.0
#include "core/slam/submap_agreement.hpp"

namespace strata::slam {

registration::MatchField field_of(const Submap& submap, double resolution_m,
                                  const registration::MatchFieldConfig& config) {
  registration::MatchField field(resolution_m, config);
  for (const registration::SurfacePoint& point : submap.points) field.add(point);
  return field;
}

SurfaceState state_near(const StateGrid& states, const Eigen::Vector2d& point_m) {
  const Cell cell = states.cell_at(point_m);
  const SurfaceState own = states.get(cell);
  if (own == SurfaceState::kUnknown) return own;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (states.get({cell.x + dx, cell.y + dy}) == SurfaceState::kOccupied) {
        return SurfaceState::kOccupied;
      }
    }
  }
  return own;
}

Agreement agreement_of(std::size_t surface, std::size_t free, std::size_t all) {
  const std::size_t seen = surface + free;
  if (seen == 0) return {};
  return {static_cast<double>(seen) / static_cast<double>(all),
          static_cast<double>(surface) / static_cast<double>(seen)};
}

}  // namespace strata::slam
