// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/current_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace strata::localizer {
namespace {

patch::MapNow shown_by(const maps::Maps& maps, const maps::MapModelDescriptor& model) {
  if (const patch::PatchMap* patches = maps::patches_of(model, maps)) {
    return patch::MapNow(*patches);
  }
  const ReflectionGrid* grid = maps::grid_of(model, maps);
  patch::PatchMap map;
  map.base = grid != nullptr ? *grid : maps.filtered;
  return patch::MapNow(map);
}

/// How often each configuration is there; of priors that are no shares, even odds.
patch::Shares shares_of(const patch::Submap& submap) {
  const double count = static_cast<double>(submap.configurations.size());
  double sum = 0.0;
  for (const patch::Configuration& one : submap.configurations) sum += std::max(0.0, one.prior);
  const bool has_sum = sum > 0.0 && std::isfinite(sum);
  patch::Shares shares;
  for (const patch::Configuration& one : submap.configurations) {
    shares.push_back(has_sum ? std::max(0.0, one.prior) / sum : 1.0 / count);
  }
  return shares;
}

/// Square roots, so that a door that was nearly sure to be shut and now is shows as news.
bool has_moved(const patch::Shares& from, const patch::Shares& to, double by) {
  if (from.size() != to.size()) return true;
  for (std::size_t k = 0; k < to.size(); ++k) {
    if (std::abs(std::sqrt(to[k]) - std::sqrt(from[k])) >= by) return true;
  }
  return false;
}

}  // namespace

CurrentMap::CurrentMap(const maps::Maps& maps, const maps::MapModelDescriptor& model,
                       const CurrentMapConfig& config)
    : config_(config), cells_(shown_by(maps, model)) {
  const patch::PatchMap* patches = maps::patches_of(model, maps);
  if (patches == nullptr) return;
  for (const patch::Submap& submap : patches->submaps) {
    beliefs_.push_back(shares_of(submap));
  }
}

std::optional<ReflectionGrid> CurrentMap::news(
    const std::vector<localization::SubmapBelief>& beliefs, std::span<const float> usual,
    Stamp now) {
  for (const localization::SubmapBelief& belief : beliefs) {
    const auto submap = static_cast<std::size_t>(belief.submap);
    if (belief.submap < 0 || submap >= beliefs_.size() ||
        belief.probability.size() != beliefs_[submap].size()) {
      continue;
    }
    beliefs_[submap] = belief.probability;
  }
  const patch::Shares usual_now(usual.begin(), usual.end());
  if (shown_) {
    const double since_s = (now - shown_->at).seconds();
    if (since_s >= 0.0 && since_s < config_.min_period_s) return std::nullopt;
    bool is_news = has_moved(shown_->usual, usual_now, config_.noticeable);
    for (std::size_t s = 0; s < beliefs_.size() && !is_news; ++s) {
      is_news = has_moved(shown_->beliefs[s], beliefs_[s], config_.noticeable);
    }
    if (!is_news) return std::nullopt;
  }
  shown_ = Shown{now, beliefs_, usual_now};
  return cells_.occupied(beliefs_);
}

}  // namespace strata::localizer
