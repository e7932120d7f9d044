// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/changed_places.hpp"

#include <algorithm>

#include "core/grid/connected_cells.hpp"
#include "core/grid/distance_field.hpp"

namespace strata::memory {
namespace {

/// Surfaces of `with` on ground that `without` knows to be free, away from all its surfaces.
Grid<std::uint8_t> surfaces_only_in(const ReflectionGrid& with, const ReflectionGrid& without,
                                    double same_within_m) {
  const DistanceField distance_m = make_distance_field(without);
  Grid<std::uint8_t> only(with.resolution_m(), with.rect());
  for (std::size_t i = 0; i < with.size(); ++i) {
    const bool is_other = is_known(without.values()[i]) && is_free(without.values()[i]) &&
                          static_cast<double>(distance_m.values()[i]) > same_within_m;
    only.values()[i] = is_occupied(with.values()[i]) && is_other ? 1 : 0;
  }
  return only;
}

void collect(const Grid<std::uint8_t>& mask, ChangeKind kind, std::size_t min_cells,
             std::vector<ChangedPlace>& places) {
  const double half_m = 0.5 * mask.resolution_m();
  for_each_component(mask, CellLink::kOverAGap, [&](const std::vector<Cell>& cells) {
    if (cells.size() < min_cells) return;
    ChangedPlace place{kind, mask.center(cells.front()), mask.center(cells.front()), cells.size()};
    for (const Cell& cell : cells) {
      place.min_m = place.min_m.cwiseMin(mask.center(cell));
      place.max_m = place.max_m.cwiseMax(mask.center(cell));
    }
    place.min_m.array() -= half_m;
    place.max_m.array() += half_m;
    places.push_back(place);
  });
}

}  // namespace

std::vector<ChangedPlace> changed_places(const NodeMap& map, int slower_level, int faster_level,
                                         const ChangeConfig& config) {
  const ReflectionGrid before = map.level_map(slower_level, config.resolution_m);
  const ReflectionGrid now = map.level_map(faster_level, config.resolution_m);
  const auto min_cells = static_cast<std::size_t>(config.min_length_m / config.resolution_m);
  std::vector<ChangedPlace> places;
  collect(surfaces_only_in(now, before, config.same_within_m), ChangeKind::kAppeared, min_cells,
          places);
  collect(surfaces_only_in(before, now, config.same_within_m), ChangeKind::kVanished, min_cells,
          places);
  std::stable_sort(places.begin(), places.end(),
                   [](const ChangedPlace& a, const ChangedPlace& b) { return a.cells > b.cells; });
  return places;
}

}  // namespace strata::memory
