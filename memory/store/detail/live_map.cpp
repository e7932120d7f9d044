// SPDX-License-Identifier: Apache-2.0
#include "memory/store/detail/live_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/grid/ray_traversal.hpp"

namespace strata::memory::detail {
namespace {

// Chosen by what visits take (docs/fleet.md).
constexpr std::int8_t kSurface = 3;
constexpr std::int8_t kWeakSurface = 1;
constexpr std::int8_t kFree = -1;
constexpr int kHit = 2;
constexpr int kPass = 2;
constexpr int kMost = 5;
constexpr int kMostConfirmed = 4;
constexpr int kLeast = -4;
constexpr int kCellsAround = 400;  ///< a visit may leave the map

/// Of format 2 for ever, whatever the rest of the project takes for occupied.
constexpr float kWeak = 0.25F;
constexpr float kStrong = 0.5F;

std::int8_t cell_of(float reflection) {
  if (!is_known(reflection)) return 0;
  if (reflection < kWeak) return kFree;
  return reflection >= kStrong ? kSurface : kWeakSurface;
}

Eigen::Vector2d point_at(const Ray& ray, double range_m) {
  return {ray.from_m.x() + range_m * ray.direction.cosine,
          ray.from_m.y() + range_m * ray.direction.sine};
}

}  // namespace

LiveMap::LiveMap(const ReflectionGrid& map)
    : cells_(map.resolution_m(), map.rect().inflated(kCellsAround), 0) {
  for (std::size_t i = 0; i < map.size(); ++i) cells_.at(map.cell(i)) = cell_of(map.values()[i]);
}

RayAhead LiveMap::look(const Ray& ray) const {
  enum class Passes { kFreeSpace, kFirst, kBehind };
  RayAhead ahead;
  Passes passes = Passes::kFreeSpace;
  double entry_m = 0.0;
  const Eigen::Vector2d to_m = point_at(ray, ray.most_cm / 100.0);
  traverse_ray(ray.from_m, to_m, resolution_m(), [&](const Cell& cell, double inside_m) -> bool {
    if (!cells_.contains(cell)) return false;
    const std::int8_t state = cells_.at(cell);
    const int middle_cm = static_cast<int>(std::floor(100.0 * (entry_m + 0.5 * inside_m) + 0.5));
    entry_m += inside_m;
    if (passes == Passes::kFreeSpace) {
      if (state == 0) ++ahead.unknown;
      if (state <= 0 || middle_cm < ray.least_cm) return true;
      ahead.first_cm = middle_cm;
      ahead.certainty = state;
      ahead.cell = cells_.index(cell);
      passes = Passes::kFirst;
    } else if (passes == Passes::kFirst) {
      if (state <= 0) passes = Passes::kBehind;
    } else if (state > 0) {
      ahead.second_cm = middle_cm;
      return false;
    }
    return true;
  });
  return ahead;
}

void LiveMap::confirm(const RayAhead& ahead) {
  if (ahead.first_cm == kNothing_cm) return;
  std::int8_t& state = cells_.values()[ahead.cell];
  if (state < kMostConfirmed) ++state;
}

void LiveMap::weaken(const RayAhead& ahead) {
  if (ahead.first_cm == kNothing_cm) return;
  std::int8_t& state = cells_.values()[ahead.cell];
  state = static_cast<std::int8_t>(std::max(kLeast, state - kPass));
}

void LiveMap::see(const Ray& ray, int range_cm) {
  const Eigen::Vector2d end_m = point_at(ray, range_cm / 100.0);
  const Cell end = cell_at(end_m, resolution_m());
  traverse_ray(ray.from_m, end_m, resolution_m(),
               [&](const Cell& cell, double /*inside_m*/) -> bool {
                 if (!cells_.contains(cell)) return false;
                 // The surface that it ended at may lie in the cells around, too.
                 if (std::abs(cell.x - end.x) <= 1 && std::abs(cell.y - end.y) <= 1) return true;
                 std::int8_t& state = cells_.at(cell);
                 if (state > -2) state = static_cast<std::int8_t>(state - kPass);
                 return true;
               });
  if (!cells_.contains(end)) return;
  std::int8_t& state = cells_.at(end);
  state = static_cast<std::int8_t>(std::min(kMost, std::max<int>(state, 0) + kHit));
}

}  // namespace strata::memory::detail
