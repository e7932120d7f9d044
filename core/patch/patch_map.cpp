// SPDX-License-Identifier: Apache-2.0
#include "core/patch/patch_map.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/patch/sequences.hpp"

namespace strata::patch {
namespace {

/// Squared distance of the cell's centre to the rectangle's, in half cells: exact.
std::int64_t squared_to_center(const CellRect& rect, const Cell& cell) {
  const std::int64_t dx = 2LL * cell.x + 1 - rect.min.x - rect.max.x;
  const std::int64_t dy = 2LL * cell.y + 1 - rect.min.y - rect.max.y;
  return dx * dx + dy * dy;
}

}  // namespace

std::vector<std::size_t> submaps_at(const PatchMap& map, const Cell& cell) {
  std::vector<std::pair<std::int64_t, std::size_t>> found;
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const CellRect& rect = map.submaps[s].rect;
    if (rect.contains(cell)) found.emplace_back(squared_to_center(rect, cell), s);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::size_t> order;
  order.reserve(found.size());
  for (const auto& entry : found) order.push_back(entry.second);
  return order;
}

int submap_at(const PatchMap& map, const Eigen::Vector2d& point_m, int current) {
  const Cell cell = cell_at(point_m, map.base.resolution_m());
  if (current >= 0 && map.submaps[static_cast<std::size_t>(current)].rect.contains(cell)) {
    return current;
  }
  int best = -1;
  std::int64_t best_squared = std::numeric_limits<std::int64_t>::max();
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const CellRect& rect = map.submaps[s].rect;
    if (!rect.contains(cell)) continue;
    const std::int64_t squared = squared_to_center(rect, cell);
    if (squared >= best_squared) continue;
    best_squared = squared;
    best = static_cast<int>(s);
  }
  return best;
}

int submap_in_reach(const PatchMap& map, const Eigen::Vector2d& point_m, double reach_m,
                    int current) {
  const int inside = submap_at(map, point_m, current);
  if (inside >= 0 || !(reach_m > 0.0)) return inside;
  const auto away_m = [&](std::size_t s) {
    return distance_m(point_m, map.submaps[s].rect, map.base.resolution_m());
  };
  if (current >= 0 && away_m(static_cast<std::size_t>(current)) <= reach_m) return current;
  int best = -1;
  double min_m = reach_m;
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const double here_m = away_m(s);
    if (here_m > min_m || (best >= 0 && here_m == min_m)) continue;
    min_m = here_m;
    best = static_cast<int>(s);
  }
  return best;
}

float reflection_at(const PatchMap& map, std::size_t s, std::size_t k, const Cell& cell) {
  const float m = map.submaps[s].configurations[k].reflection.get(cell);
  return is_known(m) ? m : map.base.get(cell);
}

ReflectionGrid compose(const PatchMap& map, const std::vector<int>& configurations, int current) {
  ReflectionGrid result = map.base;
  // How near the winner of each cell is; the sub-map the robot is in beats every other.
  CellRect all;
  for (const Submap& submap : map.submaps) all = all.united(submap.rect);
  Grid<std::int64_t> nearest(map.base.resolution_m(), all,
                             std::numeric_limits<std::int64_t>::max());
  result.grow(all);
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    if (configurations[s] < 0) continue;
    const CellRect& rect = map.submaps[s].rect;
    for (int y = rect.min.y; y < rect.max.y; ++y) {
      for (int x = rect.min.x; x < rect.max.x; ++x) {
        const Cell cell{x, y};
        const std::int64_t squared =
            static_cast<int>(s) == current ? -1 : squared_to_center(rect, cell);
        if (squared >= nearest.at(cell)) continue;
        nearest.at(cell) = squared;
        result.at(cell) = reflection_at(map, s, static_cast<std::size_t>(configurations[s]), cell);
      }
    }
  }
  return result;
}

}  // namespace strata::patch
