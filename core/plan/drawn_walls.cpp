// SPDX-License-Identifier: Apache-2.0
#include "core/plan/drawn_walls.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/connected_cells.hpp"
#include "core/grid/distance_field.hpp"

namespace strata::plan {
namespace {

constexpr double kMark_m = 0.6;
constexpr double kGap_m = 0.3;
constexpr double kPillar_m = 0.15;
constexpr double kSolid = 0.6;  // share of the box about it that is dark

bool is_mark(const std::vector<Cell>& cells, double cell_m) {
  CellRect box;
  for (const Cell& cell : cells) box = box.united({cell, {cell.x + 1, cell.y + 1}});
  if (cell_m * std::max(box.width(), box.height()) >= kMark_m) return false;
  const bool is_solid =
      static_cast<double>(cells.size()) > kSolid * static_cast<double>(box.area());
  return !is_solid || cell_m * std::min(box.width(), box.height()) < kPillar_m;
}

/// Closes gaps: what lies within half a gap of a wall, less what is as near to the rest.
void fill_gaps(ReflectionGrid& walls) {
  const int spare = 2 + static_cast<int>(0.5 * kGap_m / walls.resolution_m());
  const CellRect room = walls.rect().inflated(spare);  // so that nothing sticks to the edge
  const DistanceField to_wall = make_distance_field(walls.cropped(room), kGap_m);
  Grid<std::uint8_t> far(walls.resolution_m(), room, 0);
  for (std::size_t i = 0; i < far.size(); ++i) {
    far.values()[i] = static_cast<double>(to_wall.values()[i]) > 0.5 * kGap_m ? 1 : 0;
  }
  const DistanceField to_far = make_distance_field(far, kGap_m);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    if (static_cast<double>(to_far.at(walls.cell(i))) > 0.5 * kGap_m + walls.resolution_m()) {
      walls.values()[i] = 1.0F;
    }
  }
}

}  // namespace

ReflectionGrid drawn_walls(const ReflectionGrid& plan) {
  ReflectionGrid walls = plan;
  for_each_component(occupied_cells(plan), CellLink::kNeighbours,
                     [&](const std::vector<Cell>& cells) {
                       if (!is_mark(cells, plan.resolution_m())) return;
                       for (const Cell& cell : cells) walls.at(cell) = 0.0F;
                     });
  fill_gaps(walls);
  return walls;
}

}  // namespace strata::plan
