// SPDX-License-Identifier: Apache-2.0
#include "core/plan/plan_map.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/grid/distance_field.hpp"
#include "core/plan/drawn_walls.hpp"

namespace strata::plan {
namespace {

constexpr float kWall = 0.9F;
constexpr float kFree = 0.01F;
constexpr double kHalfWay_m = 0.7;  // half as wide as what one walks through from outside

/// The cells that an outline of a plan takes in the site's frame.
CellRect rect_of(const ReflectionGrid& plan, const SiteFromPlan& site_from_plan, double cell_m) {
  CellRect rect;
  const CellRect& from = plan.rect();
  for (const Cell& corner :
       {from.min, from.max, Cell{from.min.x, from.max.y}, Cell{from.max.x, from.min.y}}) {
    const Eigen::Vector2d at =
        site_from_plan * Eigen::Vector2d(plan.resolution_m() * Eigen::Vector2d(corner.x, corner.y));
    const Cell cell = cell_at(at, cell_m);
    rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  }
  return rect;
}

/// 1 where one walks to from outside: flooded from the edge at a distance from all walls, and from
/// there up to them.
Grid<std::uint8_t> outside(const ReflectionGrid& map) {
  const DistanceField to_wall = make_distance_field(map);
  const CellRect room = map.rect().inflated(1);  // a way round what touches the edge
  Grid<std::uint8_t> wide(map.resolution_m(), room, 0);
  std::vector<Cell> next{room.min};
  wide.at(room.min) = 1;
  while (!next.empty()) {
    const Cell cell = next.back();
    next.pop_back();
    for (const Cell& other : {Cell{cell.x - 1, cell.y}, Cell{cell.x + 1, cell.y},
                              Cell{cell.x, cell.y - 1}, Cell{cell.x, cell.y + 1}}) {
      if (!wide.contains(other) || wide.at(other) != 0) continue;
      if (map.contains(other) && static_cast<double>(to_wall.at(other)) < kHalfWay_m) continue;
      wide.at(other) = 1;
      next.push_back(other);
    }
  }
  const DistanceField to_wide = make_distance_field(wide, kHalfWay_m + map.resolution_m());
  Grid<std::uint8_t> result(map.resolution_m(), map.rect(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (static_cast<double>(to_wide.get(map.cell(i))) < kHalfWay_m) result.values()[i] = 1;
  }
  return result;
}

}  // namespace

ReflectionGrid map_of_plan(const ReflectionGrid& drawing, const SiteFromPlan& site_from_plan,
                           double cell_m) {
  const ReflectionGrid plan = drawn_walls(drawing);
  ReflectionGrid map = make_reflection_grid(cell_m, rect_of(plan, site_from_plan, cell_m));
  const Pose2 plan_from_site = inverse(site_from_plan.pose);
  const int parts = 1 + static_cast<int>(std::ceil(cell_m / plan.resolution_m()));
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.cell(i);
    bool is_wall = false;
    for (int k = 0; k < parts * parts && !is_wall; ++k) {
      const Eigen::Vector2i part(k % parts, k / parts);
      const Eigen::Vector2d inside = (part.cast<double>().array() + 0.5) / parts;
      const Eigen::Vector2d at = cell_m * (Eigen::Vector2d(cell.x, cell.y) + inside);
      is_wall = is_occupied(
          plan.get(plan.cell_at(Eigen::Vector2d(plan_from_site * at / site_from_plan.scale))));
    }
    map.values()[i] = is_wall ? kWall : kFree;
  }
  const Grid<std::uint8_t> beyond = outside(map);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (beyond.values()[i] != 0 && !is_occupied(map.values()[i])) {
      map.values()[i] = kUnknownReflection;
    }
  }
  return map;
}

}  // namespace strata::plan
