// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/met_beams.hpp"

#include <algorithm>

#include "core/rays/column_math.hpp"

namespace strata::patch_beams {
namespace {

std::size_t to_place(std::int32_t number) { return static_cast<std::size_t>(number); }

/// Whether a beam that met something ends at one of two places: at an obstacle that is there in
/// some configurations, or behind it.
bool is_pair(const ChangingBeam& beam, const ChangingBeams& changing) {
  if (beam.events == 1) return true;
  if (beam.events != 2 || !beam.is_ended) return false;
  const ChangingBeams::Event& last = changing.event(beam.last_event);
  return changing.event(last.previous).ray.submap == last.ray.submap;
}

bool is_once_each(std::span<const RayEvent> events) {
  if (events.size() > SeveralBeams::kMaxOnce) return false;
  for (std::size_t e = 1; e < events.size(); ++e) {
    for (std::size_t f = 0; f < e; ++f) {
      if (events[f].submap == events[e].submap) return false;
    }
  }
  return true;
}

// inline: called for each beam that met something, and short.
inline void list_pair(const PatchChunk& chunk, const ChangingBeam& beam,
                      const ChangingBeams& changing, std::span<const double> log_likelihood,
                      PairBeams& pairs, SubmapRatios& ratios) {
  const std::size_t log = beam.beam * chunk.bundles + beam.particle;
  const ChangingBeams::Event& last = changing.event(beam.last_event);
  const bool is_two = beam.events == 2;
  const ChangingBeams::Event& near = is_two ? changing.event(last.previous) : last;
  const float* const belief = chunk.belief(beam.particle, near.ray.submap);
  const double share = localization::probability_of(near.ray.mask, belief);
  const bool is_end = beam.is_ended && !is_two;
  pairs.share.push_back(is_end ? 1.0 : std::min(share, 1.0));
  pairs.near_log.push_back(near.log_likelihood);
  pairs.far_log.push_back(beam.is_ended ? last.log_likelihood : log_likelihood[log]);
  PairBeams::Beam& pair = pairs.beams.emplace_back();
  pair.log = log;
  pair.particle = beam.particle;
  if (!chunk.has_memory()) return;
  pair.near = near.ray.mask;
  pair.configurations = static_cast<std::uint32_t>(chunk.rows(near.ray.submap));
  pair.row = ratios.meet(to_place(near.ray.submap), pair.configurations, beam.particle);
}

/// Lists the sub-maps that a beam met, each once.
void list_submaps(const PatchChunk& chunk, SeveralBeams::Beam& beam, SeveralBeams& several,
                  SubmapRatios& ratios) {
  for (const RayEvent& event : std::span(several.events).subspan(beam.event, beam.count)) {
    const auto is_same = [&](const SeveralBeams::Met& met) { return met.submap == event.submap; };
    const auto first = several.met.begin() + static_cast<std::ptrdiff_t>(beam.met);
    if (std::any_of(first, several.met.end(), is_same)) continue;
    several.met.push_back({event.submap, ratios.meet(to_place(event.submap),
                                                     chunk.rows(event.submap), beam.particle)});
  }
  beam.met_end = several.met.size();
}

void list_several(const PatchChunk& chunk, const ChangingBeam& changed,
                  const ChangingBeams& changing, std::span<const double> log_likelihood,
                  SeveralBeams& several, SubmapRatios& ratios) {
  SeveralBeams::Beam& beam = several.beams.emplace_back();
  beam.log = changed.beam * chunk.bundles + changed.particle;
  beam.particle = changed.particle;
  beam.event = several.events.size();
  beam.value = several.likelihood.size();
  beam.count = to_place(changed.events);
  beam.met = beam.met_end = several.met.size();
  several.events.resize(beam.event + beam.count);
  several.likelihood.resize(beam.value + beam.count + 1);
  several.likelihood.back() = log_likelihood[beam.log];
  std::int32_t place = changed.last_event;
  for (std::size_t e = beam.count; e-- > 0;) {
    const ChangingBeams::Event& event = changing.event(place);
    several.events[beam.event + e] = event.ray;
    several.likelihood[beam.value + e] = event.log_likelihood;
    place = event.previous;
  }
  beam.is_once_each = is_once_each(std::span(several.events).subspan(beam.event, beam.count));
  if (chunk.has_memory()) list_submaps(chunk, beam, several, ratios);
}

void clear(MetBeams& met) {
  met.pairs.beams.clear();
  for (auto* column : {&met.pairs.share, &met.pairs.near_log, &met.pairs.far_log}) column->clear();
  met.several.beams.clear();
  met.several.events.clear();
  met.several.likelihood.clear();
  met.several.met.clear();
}

}  // namespace

void list_met_beams(const PatchChunk& chunk, const ChangingBeams& changing,
                    std::span<const double> log_likelihood, MetBeams& met, SubmapRatios& ratios) {
  clear(met);
  ratios.begin(chunk.layout.map().submaps.size(), chunk.bundles);
  for (const ChangingBeam& beam : changing.beams()) {
    if (beam.events == 0) continue;
    if (is_pair(beam, changing)) {
      list_pair(chunk, beam, changing, log_likelihood, met.pairs, ratios);
    } else {
      list_several(chunk, beam, changing, log_likelihood, met.several, ratios);
    }
  }
  rays::exp_column(met.several.likelihood.data(), met.several.likelihood.size());
}

}  // namespace strata::patch_beams
