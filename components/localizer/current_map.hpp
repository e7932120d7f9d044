// SPDX-License-Identifier: Apache-2.0
/// The map as the localizer believes it to be now.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "components/localizer/current_map_config.hpp"
#include "components/maps/map_models.hpp"
#include "core/base/time.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch/map_now.hpp"

namespace strata::localizer {

/// How likely each cell is to hold something that stops beams, 0 to 1, unknown where nobody knows:
/// in sub-maps by what is believed of their configurations, before anything is by how often each
/// is there; elsewhere 0 or 1. Without sub-maps by the map that the robot is localized in; for
/// timescale levels, which are no grids, by the filtered map.
class CurrentMap {
 public:
  CurrentMap(const maps::Maps& maps, const maps::MapModelDescriptor& model,
             const CurrentMapConfig& config);

  /// The map at the first call and whenever what is believed has moved noticeably since the last
  /// one, but not within the least period; else nothing. What is said of sub-maps that it does not
  /// have counts for nothing. usual: what is usual of all configurations, when that has to be told
  /// too; may be empty. now: of the scan; a clock that was set back starts the period anew.
  /// O(configurations), O(cells) when there is news.
  [[nodiscard]] std::optional<ReflectionGrid> news(
      const std::vector<localization::SubmapBelief>& beliefs, std::span<const float> usual,
      Stamp now);

  /// The cells and their configurations.
  [[nodiscard]] const patch::MapNow& cells() const { return cells_; }
  /// What is believed of each sub-map.
  [[nodiscard]] const std::vector<patch::Shares>& beliefs() const { return beliefs_; }

 private:
  CurrentMapConfig config_;
  patch::MapNow cells_;
  std::vector<patch::Shares> beliefs_;
  /// As of the last map.
  struct Shown {
    Stamp at;
    std::vector<patch::Shares> beliefs;
    patch::Shares usual;
  };
  std::optional<Shown> shown_;
};

}  // namespace strata::localizer
