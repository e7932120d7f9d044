// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/event_mixture.hpp"

#include <algorithm>
#include <cstdint>

namespace strata::patch_beams {

double mix_events(std::span<const RayEvent> events, std::span<const double> values,
                  double end_value, const localization::PatchStates& states,
                  std::span<const float> belief, int fixed_submap, int fixed_patch) {
  // Most beams meet the static map only.
  if (events.empty()) return end_value;
  if (events.front().submap < 0) return values.front();
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

}  // namespace strata::patch_beams
