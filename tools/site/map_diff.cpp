// SPDX-License-Identifier: Apache-2.0
#include "tools/site/map_diff.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <boost/math/special_functions/beta.hpp>

#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "core/grid/connected_cells.hpp"

namespace strata::site {
namespace {

using Mask = Grid<std::uint8_t>;

/// Things are alike when the smaller has so much of the greater one's area.
constexpr double kAlike = 0.6;

/// P(a beam that reaches the cell ends in it with at least kOccupiedReflection), after `looks` of
/// which a share of `reflection` did, from a uniform prior.
double probability_occupied(float reflection, double looks) {
  const double share = static_cast<double>(reflection);
  return boost::math::ibetac(share * looks + 1.0, (1.0 - share) * looks + 1.0,
                             static_cast<double>(kOccupiedReflection));
}

double looks_at(const DiffSide& side, const Cell& cell) {
  return side.counts.contains(cell) ? side.counts.at(cell).total() : 1.0;
}

/// 1 in the cells of a square around each occupied one.
Mask near_walls(const ReflectionGrid& map, const CellRect& rect, int reach) {
  Mask mask(map.resolution_m(), rect, 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!is_occupied(map.values()[i])) continue;
    const Cell at = map.cell(i);
    for (int y = at.y - reach; y <= at.y + reach; ++y) {
      for (int x = at.x - reach; x <= at.x + reach; ++x) {
        if (mask.contains({x, y})) mask.at({x, y}) = 1;
      }
    }
  }
  return mask;
}

/// Where `is` holds, over `rect`.
Mask cells_where(const ReflectionGrid& map, const CellRect& rect,
                 const std::function<bool(const Cell&)>& is) {
  Mask mask(map.resolution_m(), rect, 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (is(mask.cell(i))) mask.values()[i] = 1;
  }
  return mask;
}

MapChange change_of(ChangeKind kind, const std::vector<Cell>& cells, double resolution_m) {
  MapChange change;
  change.kind = kind;
  change.shape = outline(cells);
  change.area_m2 = static_cast<double>(cells.size()) * resolution_m * resolution_m;
  for (const Cell& cell : cells) change.center_m += cell_center(cell, resolution_m);
  change.center_m /= static_cast<double>(cells.size());
  return change;
}

/// What is occupied in `now` and free in `other`.
std::vector<MapChange> appeared(ChangeKind kind, const DiffSide& other, const DiffSide& now,
                                const CellRect& rect, const DiffConfig& config) {
  const double resolution_m = now.map.resolution_m();
  const int reach = static_cast<int>(std::lround(config.tolerance_m / resolution_m));
  const Mask walls = near_walls(other.map, rect, reach);
  const Mask mask = cells_where(now.map, rect, [&](const Cell& cell) {
    return is_occupied(now.map.get(cell)) && is_free(other.map.get(cell)) && walls.at(cell) == 0;
  });
  std::vector<MapChange> changes;
  for_each_component(mask, CellLink::kOverAGap, [&](const std::vector<Cell>& cells) {
    MapChange change = change_of(kind, cells, resolution_m);
    if (change.area_m2 < config.min_area_m2) return;
    change.confidence = 0.0;
    for (const Cell& cell : cells) {
      const double is_there = probability_occupied(now.map.get(cell), looks_at(now, cell));
      const double was_free =
          1.0 - probability_occupied(other.map.get(cell), looks_at(other, cell));
      change.confidence += is_there * was_free / static_cast<double>(cells.size());
    }
    changes.push_back(std::move(change));
  });
  return changes;
}

/// What `now` knows and `other` does not.
void add_known(ChangeKind kind, const DiffSide& other, const DiffSide& now, const CellRect& rect,
               const DiffConfig& config, std::vector<MapChange>& changes) {
  const Mask mask = cells_where(now.map, rect, [&](const Cell& cell) {
    return is_free(now.map.get(cell)) && !is_known(other.map.get(cell));
  });
  for_each_component(mask, CellLink::kNeighbours, [&](const std::vector<Cell>& cells) {
    MapChange change = change_of(kind, cells, now.map.resolution_m());
    if (change.area_m2 >= config.min_explored_m2) changes.push_back(std::move(change));
  });
}

std::vector<Cell> cells_of(const CellRect& rect) {
  std::vector<Cell> cells;
  for (int y = rect.min.y; y < rect.max.y; ++y) {
    for (int x = rect.min.x; x < rect.max.x; ++x) cells.push_back({x, y});
  }
  return cells;
}

void add_places(ChangeKind kind, const DiffSide& other, const DiffSide& now,
                std::vector<MapChange>& changes) {
  for (const patch::Submap& submap : now.submaps) {
    const bool is_known = std::any_of(
        other.submaps.begin(), other.submaps.end(),
        [&](const patch::Submap& one) { return !one.rect.intersected(submap.rect).empty(); });
    if (!is_known) {
      changes.push_back(change_of(kind, cells_of(submap.rect), now.map.resolution_m()));
    }
  }
}

/// Pairs each thing that came with the nearest that went and is alike.
void pair_moved(std::vector<MapChange>& came, std::vector<MapChange>& went,
                const DiffConfig& config) {
  for (MapChange& thing : came) {
    auto best = went.end();
    double best_m = config.max_move_m;
    for (auto other = went.begin(); other != went.end(); ++other) {
      const double distance_m = (other->center_m - thing.center_m).norm();
      const double alike =
          std::min(other->area_m2, thing.area_m2) / std::max(other->area_m2, thing.area_m2);
      if (distance_m > best_m || alike < kAlike) continue;
      best = other;
      best_m = distance_m;
    }
    if (best == went.end()) continue;
    thing.kind = ChangeKind::kMoved;
    thing.from_m = best->center_m;
    thing.confidence = std::min(thing.confidence, best->confidence);
    went.erase(best);
  }
}

}  // namespace

DiffSide read_diff_side(const std::filesystem::path& folder) {
  const memory::Store store = maps::open_for_reading(folder);
  DiffSide side;
  if (store.has_grid("filtered")) side.map = store.load_reflection_grid("filtered");
  if (store.has_grid("counts")) side.counts = store.load_counts_grid("counts");
  if (store.has_patch_map()) side.submaps = store.load_patch_map().submaps;
  return side;
}

const char* name_of(ChangeKind kind) {
  constexpr const char* kNames[] = {"came",      "went",       "moved",     "explored",
                                    "forgotten", "place_came", "place_went"};
  return kNames[static_cast<std::size_t>(kind)];
}

MapDiff map_diff(const DiffSide& before, const DiffSide& after, const DiffConfig& config) {
  if (before.map.resolution_m() != after.map.resolution_m()) {
    throw InputError("the maps", "have cells of different sizes", "learn both with one resolution");
  }
  const CellRect rect = before.map.rect().united(after.map.rect());
  std::vector<MapChange> came = appeared(ChangeKind::kCame, before, after, rect, config);
  std::vector<MapChange> went = appeared(ChangeKind::kWent, after, before, rect, config);
  pair_moved(came, went, config);
  MapDiff diff{after.map.resolution_m(), std::move(came)};
  diff.changes.insert(diff.changes.end(), went.begin(), went.end());
  add_known(ChangeKind::kExplored, before, after, rect, config, diff.changes);
  add_known(ChangeKind::kForgotten, after, before, rect, config, diff.changes);
  add_places(ChangeKind::kPlaceCame, before, after, diff.changes);
  add_places(ChangeKind::kPlaceWent, after, before, diff.changes);
  std::stable_sort(diff.changes.begin(), diff.changes.end(),
                   [](const MapChange& a, const MapChange& b) {
                     return std::pair(a.kind, -a.area_m2) < std::pair(b.kind, -b.area_m2);
                   });
  return diff;
}

}  // namespace strata::site
