// SPDX-License-Identifier: Apache-2.0
#include "core/patch/patch_map.hpp"

#include <limits>

namespace strata::patch {

int submap_at(const PatchMap& map, const Eigen::Vector2d& point_m, int current) {
  const double resolution = map.base.resolution_m();
  const Cell cell = cell_at(point_m, resolution);
  if (current >= 0 && map.submaps[static_cast<std::size_t>(current)].rect.contains(cell)) {
    return current;
  }
  int best = -1;
  double best_squared = std::numeric_limits<double>::infinity();
  for (const Submap& submap : map.submaps) {
    if (!submap.rect.contains(cell)) continue;
    const Eigen::Vector2d center(0.5 * resolution * (submap.rect.min.x + submap.rect.max.x),
                                 0.5 * resolution * (submap.rect.min.y + submap.rect.max.y));
    const double squared = (center - point_m).squaredNorm();
    if (squared < best_squared) {
      best_squared = squared;
      best = submap.id;
    }
  }
  return best;
}

ReflectionGrid compose(const PatchMap& map, const std::vector<int>& configurations) {
  ReflectionGrid result = map.base;
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    if (configurations[s] < 0) continue;
    const ReflectionGrid& patch =
        map.submaps[s].configurations[static_cast<std::size_t>(configurations[s])].reflection;
    result.grow(patch.rect());
    for (std::size_t i = 0; i < patch.size(); ++i) {
      if (is_known(patch.values()[i])) result.at(patch.cell(i)) = patch.values()[i];
    }
  }
  return result;
}

}  // namespace strata::patch
