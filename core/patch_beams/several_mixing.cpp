// SPDX-License-Identifier: Apache-2.0
// What the beams that met several sub-maps say of the particle and of these.
#include <algorithm>

#include "core/patch_beams/beam_mixing.hpp"
#include "core/patch_beams/event_mixture.hpp"
#include "core/rays/column_math.hpp"

namespace strata::patch_beams {
namespace {

/// What mix_events says of a beam that met each of several sub-maps once, as most do: for each of
/// them at once what it says when that one is known, in O(events).
class OnceEach {
 public:
  /// probability(event): that it ends the beam if nothing before does. values: of the events, then
  /// of the end. Requires SeveralBeams::kMaxOnce events at most.
  template <typename Probability>
  OnceEach(std::span<const RayEvent> events, const double* values, Probability&& probability)
      : values_(values) {
    from_[events.size()] = values[events.size()];
    for (std::size_t e = events.size(); e-- > 0;) {
      there_[e] = std::min(1.0, probability(events[e]));
      from_[e] = there_[e] * values[e] + (1.0 - there_[e]) * from_[e + 1];
    }
  }
  [[nodiscard]] double mixed() const { return from_[0]; }
  /// Calls take(p when event e ends the beam if it comes so far, p when it does not) for all, in
  /// order.
  template <typename Take>
  void for_each(std::size_t events, Take&& take) const {
    double before = 0.0;
    double reach = 1.0;
    for (std::size_t e = 0; e < events; ++e) {
      take(before + reach * values_[e], before + reach * from_[e + 1]);
      before += reach * there_[e] * values_[e];
      reach *= 1.0 - there_[e];
    }
  }

 private:
  const double* values_;
  double there_[SeveralBeams::kMaxOnce];
  double from_[SeveralBeams::kMaxOnce + 1];  // what it says if nothing before event e ends it
};

/// Appends p of the mixture, then with memory of each of its events: that it is there, that not.
// inline: called for each such beam.
inline void mix_once_each(const PatchChunk& chunk, const SeveralBeams& several,
                          const SeveralBeams::Beam& beam, std::vector<double>& mixed) {
  const auto events = std::span(several.events).subspan(beam.event, beam.count);
  const std::int32_t fixed = chunk.states.fixed(beam.particle);
  const std::int32_t known = fixed >= 0 ? chunk.states.submap[beam.particle] : -1;
  const OnceEach once(events, several.likelihood.data() + beam.value, [&](const RayEvent& event) {
    if (event.submap == known) return (event.mask >> fixed & 1U) != 0 ? 1.0 : 0.0;
    return localization::probability_of(event.mask, chunk.belief(beam.particle, event.submap));
  });
  mixed.push_back(once.mixed());
  if (!chunk.has_memory()) return;
  once.for_each(events.size(), [&](double there, double absent) {
    mixed.push_back(there);
    mixed.push_back(absent);
  });
}

/// Appends p of the mixture, then with memory for each configuration of each sub-map that it met.
void mix_any(const PatchChunk& chunk, const SeveralBeams& several, const SeveralBeams::Beam& beam,
             std::vector<double>& mixed) {
  const auto events = std::span(several.events).subspan(beam.event, beam.count);
  const auto values = std::span(several.likelihood).subspan(beam.value, beam.count);
  const double end_value = several.likelihood[beam.value + beam.count];
  const std::span<const float> believed = chunk.beliefs.of(beam.particle);
  const auto mix = [&](int s, int k) {
    mixed.push_back(mix_events(events, values, end_value, chunk.layout, believed, s, k));
  };
  const bool has_memory = chunk.has_memory();
  mix(has_memory ? -1 : chunk.states.submap[beam.particle],
      has_memory ? -1 : chunk.states.fixed(beam.particle));
  for (std::size_t n = beam.met; n < beam.met_end; ++n) {
    const std::int32_t submap = several.met[n].submap;
    const auto configurations = static_cast<int>(chunk.rows(submap));
    for (int k = 0; k < configurations; ++k) mix(submap, k);
  }
}

/// Adds what a beam says of the sub-maps that it met; next: behind its mixture in the list of
/// logarithms. Returns where the next beam begins.
const double* add_ratios(const PatchChunk& chunk, const SeveralBeams& several,
                         const SeveralBeams::Beam& beam, double mixed, const double* next,
                         SubmapRatios& ratios) {
  for (std::size_t n = beam.met; n < beam.met_end; ++n) {
    const SeveralBeams::Met& met = several.met[n];
    const std::size_t configurations = chunk.rows(met.submap);
    if (!beam.is_once_each) {
      for (std::size_t k = 0; k < configurations; ++k) {
        ratios.at(met.row + k, beam.particle) += *next++ - mixed;
      }
      continue;
    }
    const std::uint64_t mask = several.events[beam.event + n - beam.met].mask;
    const double there = *next++ - mixed;
    const double absent = *next++ - mixed;
    for (std::size_t k = 0; k < configurations; ++k) {
      ratios.at(met.row + k, beam.particle) += (mask >> k & 1U) != 0 ? there : absent;
    }
  }
  return next;
}

}  // namespace

void mix_several(const PatchChunk& chunk, const SeveralBeams& several,
                 std::span<double> log_likelihood, SubmapRatios& ratios,
                 std::vector<double>& mixed) {
  mixed.clear();
  for (const SeveralBeams::Beam& beam : several.beams) {
    if (beam.is_once_each) {
      mix_once_each(chunk, several, beam, mixed);
    } else {
      mix_any(chunk, several, beam, mixed);
    }
  }
  rays::log_column(mixed.data(), mixed.size());
  const double* next = mixed.data();
  for (const SeveralBeams::Beam& beam : several.beams) {
    const double of_beam = *next++;
    log_likelihood[beam.log] = of_beam;
    next = add_ratios(chunk, several, beam, of_beam, next, ratios);
  }
}

}  // namespace strata::patch_beams
