// SPDX-License-Identifier: Apache-2.0
/// The map as the localizer believes it to be now.
#pragma once

#include <optional>
#include <vector>

#include "components/maps/map_models.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch/patch_map.hpp"

namespace strata::localizer {

/// With sub-maps: the base map, and in each sub-map the configuration that is more likely than all
/// others together; until one is, the last that was, and since this map came the one seen most.
/// Without: the map that the robot is localized in; for timescale levels, which are no grids, the
/// filtered map.
class CurrentMap {
 public:
  CurrentMap(const maps::Maps& maps, const maps::MapModelDescriptor& model);

  /// The map at the first call and whenever a sub-map shows another configuration; else nothing.
  /// O(sub-maps), O(cells) when there is news.
  [[nodiscard]] std::optional<ReflectionGrid> news(
      const std::vector<localization::SubmapBelief>& beliefs);

 private:
  patch::PatchMap map_;  ///< without counts and sequences, which nobody asks for here
  std::vector<int> shown_;
  bool is_known_ = false;
};

}  // namespace strata::localizer
