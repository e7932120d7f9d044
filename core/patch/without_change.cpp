// SPDX-License-Identifier: Apache-2.0
#include "core/patch/without_change.hpp"

#include <cstddef>

namespace strata::patch {

void keep_static(PatchMap& map, const Grid<std::uint8_t>& cells) {
  const auto is_static = [&](const Cell& cell) { return cells.get(cell) != 0; };
  std::erase_if(map.submaps, [&](Submap& submap) {
    bool is_touched = false;
    bool changes = false;
    for (std::size_t i = 0; i < submap.contradictory.size(); ++i) {
      std::uint8_t& contradicts = submap.contradictory.values()[i];
      if (is_static(submap.contradictory.cell(i))) {
        is_touched = true;
        contradicts = 0;
      }
      changes = changes || contradicts != 0;
    }
    if (!is_touched) return false;
    for (Configuration& one : submap.configurations) {
      for (std::size_t i = 0; i < one.reflection.size(); ++i) {
        const Cell cell = one.reflection.cell(i);
        if (is_static(cell)) one.reflection.values()[i] = map.base.get(cell);
      }
    }
    return !changes;
  });
  for (std::size_t s = 0; s < map.submaps.size(); ++s) map.submaps[s].id = static_cast<int>(s);
}

}  // namespace strata::patch
