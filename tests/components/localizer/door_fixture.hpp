// SPDX-License-Identifier: Apache-2.0
/// A localizer in the room's maps with a door that is mostly open, and asked for a mask of change.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/patch/patch_map.hpp"
#include "tests/components/localizer/live_fixture.hpp"

namespace strata::localizer {

class LiveDoor : public LiveLocalizer {
 protected:
  static constexpr double kRate_per_s = 1.0 / 600.0;
  static constexpr double kUsuallyShut = 0.3;

  /// The room with a leaf of three cells at each of these places, in an area of its own.
  [[nodiscard]] static patch::PatchMap with_doors(const std::vector<Cell>& leaves) {
    patch::PatchMap map;
    map.base = maps::read_maps(room().folder.path()).filtered;
    for (const Cell& leaf : leaves) {
      patch::Submap submap;
      submap.id = static_cast<int>(map.submaps.size());
      submap.rect = CellRect{leaf, {leaf.x + 3, leaf.y + 1}}.inflated(2);
      submap.contradictory = Grid<std::uint8_t>(map.base.resolution_m(), submap.rect, 0);
      for (const double share : {1.0 - kUsuallyShut, kUsuallyShut}) {
        patch::Configuration state;
        state.counts = Grid<CellCounts>(map.base.resolution_m(), submap.rect);
        state.reflection = ReflectionGrid(map.base.resolution_m(), submap.rect, 0.02F);
        state.prior = share;
        const float m = share == kUsuallyShut ? 0.9F : 0.02F;
        for (int x = 0; x < 3; ++x) state.reflection.at({leaf.x + x, leaf.y}) = m;
        submap.configurations.push_back(std::move(state));
      }
      submap.change_rate_per_s = kRate_per_s;
      map.submaps.push_back(std::move(submap));
    }
    return map;
  }

  /// In the place of the one that runs; mask: of the settings in change_mask.
  void start_with_doors(const std::vector<Cell>& leaves, const std::string& mask) {
    namespace fs = std::filesystem;
    const fs::path maps = folder_.path() / "maps";
    fs::copy(room().folder.path(), maps, fs::copy_options::recursive);
    maps::write_patch_map(maps, with_doors(leaves));
    std::string text = parameters_of("patch", false);
    const std::string before = room().folder.path().string();
    text.replace(text.find(before), before.size(), maps.string());
    text.pop_back();
    start(text + ", map_topics: {follow: true}, change_mask: {" + mask + "}}");
  }

  test::TemporaryDirectory folder_;
};

}  // namespace strata::localizer
