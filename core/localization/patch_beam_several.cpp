// SPDX-License-Identifier: Apache-2.0
// What the beams that met several sub-maps say of the particle and of these.
#include <algorithm>

#include "core/localization/column_math.hpp"
#include "core/localization/patch_beam_model.hpp"

namespace strata::localization {
namespace {

std::size_t to_place(std::int32_t number) { return static_cast<std::size_t>(number); }

/// What mix_events says of a beam that met each of several sub-maps once, as most do: for each of
/// them at once what it says when that one is known, in O(events).
class OnceEach {
 public:
  static constexpr std::size_t kMost = 8;

  /// Whether the beam is one of these.
  static bool holds(std::span<const RayEvent> events) {
    if (events.size() > kMost) return false;
    for (std::size_t e = 1; e < events.size(); ++e) {
      for (std::size_t f = 0; f < e; ++f) {
        if (events[f].submap == events[e].submap) return false;
      }
    }
    return true;
  }
  /// probability(event): that it ends the beam if nothing before does. values: of the events, then
  /// of the end.
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
  double there_[kMost];
  double from_[kMost + 1];  // what the beam says if nothing before event e ends it
};

}  // namespace

void PatchBeamModel::list_other(const ChangingBeam& beam, Scratch& scratch) const {
  const std::size_t log = beam.beam * scratch.lasers.padded() + beam.particle;
  OtherBeam& other = scratch.others.emplace_back();
  other.log = log;
  other.particle = beam.particle;
  other.event = scratch.events.size();
  other.value = scratch.value.size();
  other.events = to_place(beam.events);
  other.met = other.met_end = scratch.met.size();
  scratch.events.resize(other.event + other.events);
  scratch.value.resize(other.value + other.events + 1);
  scratch.value.back() = scratch.logs[log];
  std::int32_t place = beam.last_event;
  for (std::size_t e = other.events; e-- > 0;) {
    const ChangingBeams::Event& event = scratch.changing.event(place);
    scratch.events[other.event + e] = event.ray;
    scratch.value[other.value + e] = event.log_likelihood;
    place = event.previous;
  }
  if (states_.memory() == PatchMemory::kNone) return;
  for (std::size_t e = other.event; e < scratch.events.size(); ++e) {
    const std::int32_t submap = scratch.events[e].submap;
    const auto is_same = [&](const MetSubmap& met) { return met.submap == submap; };
    const auto first = scratch.met.begin() + static_cast<std::ptrdiff_t>(other.met);
    if (std::any_of(first, scratch.met.end(), is_same)) continue;
    const auto configurations = to_place(states_.count(to_place(submap)));
    scratch.met.push_back(
        {submap, scratch.said.meet(to_place(submap), configurations, other.particle)});
  }
  other.met_end = scratch.met.size();
}

/// For any number of events: docs/theory/patch_localization.md, "Beams through sub-maps".
void PatchBeamModel::mix_others(const Beliefs& beliefs, const ChunkStates& states,
                                Scratch& scratch) const {
  exp_column(scratch.value.data(), scratch.value.size());
  scratch.mixed.clear();
  for (OtherBeam& other : scratch.others) {
    const auto events = std::span(scratch.events).subspan(other.event, other.events);
    other.is_once_each = OnceEach::holds(events);
    if (other.is_once_each) {
      mix_once_each(other, events, beliefs, states, scratch);
    } else {
      mix_any(other, events, beliefs, states, scratch);
    }
  }
  log_column(scratch.mixed.data(), scratch.mixed.size());
  const double* next = scratch.mixed.data();
  for (const OtherBeam& other : scratch.others) {
    const double mixed = *next++;
    scratch.logs[other.log] = mixed;
    for (std::size_t n = other.met; n < other.met_end; ++n) {
      const MetSubmap& met = scratch.met[n];
      const auto configurations = to_place(states_.count(to_place(met.submap)));
      if (!other.is_once_each) {
        for (std::size_t k = 0; k < configurations; ++k) {
          scratch.said.at(met.row + k, other.particle) += *next++ - mixed;
        }
        continue;
      }
      const std::uint64_t mask = scratch.events[other.event + n - other.met].mask;
      const double there = *next++ - mixed;
      const double absent = *next++ - mixed;
      for (std::size_t k = 0; k < configurations; ++k) {
        scratch.said.at(met.row + k, other.particle) += (mask >> k & 1U) != 0 ? there : absent;
      }
    }
  }
}

// inline: called for each such beam.
inline void PatchBeamModel::mix_once_each(const OtherBeam& other, std::span<const RayEvent> events,
                                          const Beliefs& beliefs, const ChunkStates& states,
                                          Scratch& scratch) const {
  const std::span<const float> believed = beliefs.of(other.particle);
  const std::int32_t known = states.fixed(other.particle) >= 0 ? states.submap[other.particle] : -1;
  const OnceEach once(events, scratch.value.data() + other.value, [&](const RayEvent& event) {
    if (event.submap == known) {
      return (event.mask >> states.fixed(other.particle) & 1U) != 0 ? 1.0 : 0.0;
    }
    return probability_of(event.mask, believed.data() + states_.offset(to_place(event.submap)));
  });
  scratch.mixed.push_back(once.mixed());
  if (states_.memory() == PatchMemory::kNone) return;
  once.for_each(events.size(), [&](double there, double absent) {
    scratch.mixed.push_back(there);
    scratch.mixed.push_back(absent);
  });
}

void PatchBeamModel::mix_any(const OtherBeam& other, std::span<const RayEvent> events,
                             const Beliefs& beliefs, const ChunkStates& states,
                             Scratch& scratch) const {
  const auto values = std::span(scratch.value).subspan(other.value, other.events);
  const double end_value = scratch.value[other.value + other.events];
  const std::span<const float> believed = beliefs.of(other.particle);
  const auto mix = [&](int s, int k) {
    scratch.mixed.push_back(mix_events(events, values, end_value, states_, believed, s, k));
  };
  const bool has_memory = states_.memory() != PatchMemory::kNone;
  mix(has_memory ? -1 : states.submap[other.particle],
      has_memory ? -1 : states.fixed(other.particle));
  for (std::size_t n = other.met; n < other.met_end; ++n) {
    const std::int32_t submap = scratch.met[n].submap;
    for (int k = 0; k < states_.count(to_place(submap)); ++k) mix(submap, k);
  }
}

}  // namespace strata::localization
