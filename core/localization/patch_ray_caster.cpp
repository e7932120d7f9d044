// SPDX-License-Identifier: Apache-2.0
#include "core/localization/patch_ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace strata::localization {
namespace {

std::uint64_t occupied_mask(const patch::PatchMap& map, std::size_t s, const Cell& cell) {
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < map.submaps[s].configurations.size(); ++k) {
    if (is_occupied(patch::reflection_at(map, s, k, cell))) mask |= std::uint64_t{1} << k;
  }
  return mask;
}

}  // namespace

PatchRayCaster::PatchRayCaster(const patch::PatchMap& map) {
  CellRect rect = map.base.rect();
  for (const patch::Submap& submap : map.submaps) {
    rect = rect.united(submap.rect);
    const std::size_t count = submap.configurations.size();
    all_.push_back(count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1);
    for (const patch::Configuration& configuration : submap.configurations) {
      if (configuration.reflection.resolution_m() != map.base.resolution_m()) {
        throw InputError("sub-map " + std::to_string(submap.id),
                         "has another resolution than the base map", "learn the maps together");
      }
    }
  }
  Grid<std::uint8_t> marked(map.base.resolution_m(), rect);
  first_owner_ = Grid<std::int32_t>(map.base.resolution_m(), rect, -1);
  Grid<std::uint8_t> inside(map.base.resolution_m(), rect);
  for (const patch::Submap& submap : map.submaps) {
    for (int y = submap.rect.min.y; y < submap.rect.max.y; ++y) {
      for (int x = submap.rect.min.x; x < submap.rect.max.x; ++x) inside.at({x, y}) = 1;
    }
  }
  for (std::size_t i = 0; i < marked.size(); ++i) {
    const Cell cell = marked.cell(i);
    if (inside.values()[i] == 0) {
      marked.values()[i] = is_occupied(map.base.get(cell)) ? 1 : 0;
      continue;
    }
    std::vector<Owner> owners;
    std::uint64_t any = 0;
    bool is_certain = true;
    for (const std::size_t s : patch::submaps_at(map, cell)) {
      owners.push_back({static_cast<std::int32_t>(s), occupied_mask(map, s, cell), false, false});
      any |= owners.back().mask;
      is_certain = is_certain && owners.back().mask == all_[s];
    }
    if (any == 0) continue;
    marked.values()[i] = 1;
    owners.back().is_last = true;
    owners.front().is_certain = is_certain;
    first_owner_.values()[i] = static_cast<std::int32_t>(owners_.size());
    owners_.insert(owners_.end(), owners.begin(), owners.end());
  }
  walker_ = RayWalker(marked);
}

void PatchRayCaster::events(double x_m, double y_m, double c, double s, double max_range_m,
                            int current, std::vector<RayEvent>& events) const {
  events.clear();
  const auto visit = [&](std::size_t index, double entry_m, double exit_m) {
    const double range_m = 0.5 * (entry_m + exit_m);
    const std::int32_t first = first_owner_.values()[index];
    if (first < 0) {
      events.push_back({-1, 0, range_m});
      return false;
    }
    const Owner* owner = &owners_[static_cast<std::size_t>(first)];
    for (const Owner* other = owner;; ++other) {
      if (other->submap == current) {
        owner = other;
        break;
      }
      if (other->is_last) break;
    }
    std::uint64_t ended = 0;
    for (const RayEvent& event : events) {
      if (event.submap == owner->submap) ended |= event.mask;
    }
    const std::uint64_t fresh = owner->mask & ~ended;
    if (fresh != 0) events.push_back({owner->submap, fresh, range_m});
    return (ended | fresh) != all_[static_cast<std::size_t>(owner->submap)];
  };
  walker_.walk(x_m, y_m, c, s, max_range_m, visit);
}

double mix_events(const std::vector<RayEvent>& events, const std::vector<double>& values,
                  double end_value, const PatchStates& states, std::span<const float> belief,
                  int fixed_submap, int fixed_patch) {
  const auto probability = [&](const RayEvent& event) {
    if (event.submap == fixed_submap) return (event.mask >> fixed_patch & 1U) != 0 ? 1.0 : 0.0;
    const auto s = static_cast<std::size_t>(event.submap);
    double sum = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(states.count(s)); ++k) {
      if ((event.mask >> k & 1U) != 0) sum += static_cast<double>(belief[states.offset(s) + k]);
    }
    return sum;
  };
  // P(no sub-map ended the beam before event `until`), leaving out sub-map `without`.
  const auto reach = [&](std::size_t until, std::int32_t without) {
    double product = 1.0;
    for (std::size_t e = 0; e < until; ++e) {
      const std::int32_t s = events[e].submap;
      bool is_first = s != without && s >= 0;
      for (std::size_t f = 0; f < e; ++f) is_first = is_first && events[f].submap != s;
      if (!is_first) continue;
      double ended = 0.0;
      for (std::size_t f = e; f < until; ++f) {
        if (events[f].submap == s) ended += probability(events[f]);
      }
      product *= std::max(0.0, 1.0 - ended);
    }
    return product;
  };
  double p = 0.0;
  for (std::size_t e = 0; e < events.size(); ++e) {
    const double before = reach(e, events[e].submap);
    if (events[e].submap < 0) return p + before * values[e];
    p += before * probability(events[e]) * values[e];
  }
  return p + reach(events.size(), -1) * end_value;
}

}  // namespace strata::localization
