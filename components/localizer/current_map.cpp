// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/current_map.hpp"

#include <algorithm>
#include <cstddef>

namespace strata::localizer {
namespace {

constexpr double kMoreLikelyThanAllOthers = 0.5;

int most_seen(const patch::Submap& submap) {
  const auto best =
      std::max_element(submap.configurations.begin(), submap.configurations.end(),
                       [](const patch::Configuration& a, const patch::Configuration& b) {
                         return a.prior < b.prior;
                       });
  return static_cast<int>(best - submap.configurations.begin());
}

}  // namespace

CurrentMap::CurrentMap(const maps::Maps& maps, const maps::MapModelDescriptor& model) {
  const patch::PatchMap* patches = maps::patches_of(model, maps);
  if (patches == nullptr) {
    const ReflectionGrid* grid = maps::grid_of(model, maps);
    map_.base = grid != nullptr ? *grid : maps.filtered;
    return;
  }
  map_.base = patches->base;
  for (const patch::Submap& submap : patches->submaps) {
    patch::Submap kept;
    kept.id = submap.id;
    kept.rect = submap.rect;
    for (const patch::Configuration& configuration : submap.configurations) {
      kept.configurations.push_back({{}, configuration.reflection, configuration.prior});
    }
    shown_.push_back(most_seen(submap));
    map_.submaps.push_back(std::move(kept));
  }
}

std::optional<ReflectionGrid> CurrentMap::news(
    const std::vector<localization::SubmapBelief>& beliefs) {
  bool is_news = !is_known_;
  for (const localization::SubmapBelief& belief : beliefs) {
    const auto submap = static_cast<std::size_t>(belief.submap);
    if (belief.submap < 0 || submap >= shown_.size()) continue;
    for (std::size_t k = 0; k < belief.probability.size(); ++k) {
      if (belief.probability[k] <= kMoreLikelyThanAllOthers) continue;
      is_news = is_news || shown_[submap] != static_cast<int>(k);
      shown_[submap] = static_cast<int>(k);
    }
  }
  if (!is_news) return std::nullopt;
  is_known_ = true;
  return patch::compose(map_, shown_);
}

}  // namespace strata::localizer
