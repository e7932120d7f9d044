// SPDX-License-Identifier: Apache-2.0
// What the beams that met changing cells say of the particle and of the sub-maps.
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/localization/column_math.hpp"
#include "core/localization/patch_beam_model.hpp"

namespace strata::localization {
namespace {

std::size_t to_place(std::int32_t number) { return static_cast<std::size_t>(number); }

/// The probability of a set of configurations.
double probability_of(std::uint64_t mask, const float* belief) {
  double sum = 0.0;
  for (std::uint64_t left = mask; left != 0; left &= left - 1) {
    sum += static_cast<double>(belief[std::countr_zero(left)]);
  }
  return sum;
}

/// Whether a beam that met something ends at one of two places: at an obstacle that is there in
/// some configurations, or behind it.
bool is_pair(const ChangingBeam& beam, const ChangingBeams& changing) {
  if (beam.events == 1) return true;
  if (beam.events != 2 || !beam.is_ended) return false;
  const ChangingBeams::Event& last = changing.event(beam.last_event);
  return changing.event(last.previous).ray.submap == last.ray.submap;
}

/// mix_events for a beam that met two different sub-maps, as most that met several did; the same
/// bits.
class TwoEvents {
 public:
  TwoEvents(std::span<const RayEvent> events, std::span<const double> values, double end_value,
            const PatchStates& states, std::span<const float> belief)
      : events_(events), values_(values), end_value_(end_value) {
    is_all_ = events.size() == 2 && events[0].submap != events[1].submap;
    for (std::size_t e = 0; e < 2 && is_all_; ++e) {
      const float* const own = belief.data() + states.offset(to_place(events[e].submap));
      probability_[e] = probability_of(events[e].mask, own);
    }
  }
  /// Whether there are no others.
  [[nodiscard]] bool is_all() const { return is_all_; }
  [[nodiscard]] double mixed(int fixed_submap, int fixed_patch) const {
    const double near = probability(0, fixed_submap, fixed_patch);
    const double far = probability(1, fixed_submap, fixed_patch);
    const double past_near = std::max(0.0, 1.0 - near);
    const double past_far = std::max(0.0, 1.0 - far);
    return near * values_[0] + past_near * far * values_[1] + past_near * past_far * end_value_;
  }

 private:
  [[nodiscard]] double probability(std::size_t e, int fixed_submap, int fixed_patch) const {
    if (events_[e].submap != fixed_submap) return probability_[e];
    return (events_[e].mask >> fixed_patch & 1U) != 0 ? 1.0 : 0.0;
  }

  std::span<const RayEvent> events_;
  std::span<const double> values_;
  double end_value_;
  bool is_all_ = false;
  double probability_[2] = {0.0, 0.0};
};

}  // namespace

PatchBeamModel::Beliefs PatchBeamModel::beliefs(const ParticleSet& particles,
                                                std::size_t begin) const {
  const std::size_t columns = states_.columns();
  switch (states_.memory()) {
    case PatchMemory::kNone:
      return {states_.uniform().data(), columns, 0};
    case PatchMemory::kShared:
      return {particles.shared_belief.data(), columns, 0};
    case PatchMemory::kPerParticle:
      break;
  }
  return {particles.belief(begin).data(), columns, columns};
}

/// Mixes the beams that ChangingBeams keeps apart.
void PatchBeamModel::mix_single(const ScanMixture& mixture, const Beliefs& beliefs,
                                const ChunkStates& states, Scratch& scratch) const {
  const SeenBoxes& boxes = scratch.boxes;
  SingleBeams& single = scratch.changing.single();
  if (single.size() == 0) return;
  const std::size_t row = boxes.lasers();
  const auto for_all = [&](auto&& what) {
    for (std::size_t box = 0; box < boxes.size(); ++box) {
      if (!boxes.is_uniform(box)) continue;
      for (std::size_t n = 0; n < scratch.lasers.count(); ++n) {
        if (boxes.counts(box, n)) what(boxes.content(box, n), box * row + n, n);
      }
    }
  };
  scratch.box_share.assign(boxes.size() * row, 0.0);
  for_all([&](const CellOwner& cells, std::size_t place, std::size_t n) {
    const bool is_known = cells.submap == states.submap[n] && states.fixed(n) >= 0;
    const bool is_there = is_known || cells.mask == caster_.all(cells.submap);
    const float* const own = beliefs.of(n).data() + states_.offset(to_place(cells.submap));
    scratch.box_share[place] = is_there ? 1.0 : std::min(1.0, probability_of(cells.mask, own));
  });
  single.mix(mixture, row, scratch.box_share, scratch.logs.data());
  if (states_.memory() == PatchMemory::kNone) return;
  const SingleBeams::Sums& sums = single.sums();
  for_all([&](const CellOwner& cells, std::size_t place, std::size_t n) {
    if (sums.beams[place] == 0.0) return;
    const auto configurations = to_place(states_.count(to_place(cells.submap)));
    const std::size_t first = scratch.said.meet(to_place(cells.submap), configurations, n);
    for (std::size_t k = 0; k < configurations; ++k) {
      scratch.said.at(first + k, n) +=
          (cells.mask >> k & 1U) != 0 ? sums.near[place] : sums.far[place];
    }
  });
}

/// Lists the beams of all particles that met something.
void PatchBeamModel::list_beams(const Beliefs& beliefs, Scratch& scratch) const {
  for (auto* list : {&scratch.share, &scratch.first, &scratch.second}) list->clear();
  scratch.pairs.clear();
  scratch.others.clear();
  scratch.events.clear();
  scratch.value.clear();
  scratch.met.clear();
  scratch.said.begin(states_.map().submaps.size(), scratch.lasers.padded());
  for (const ChangingBeam& beam : scratch.changing.beams()) {
    if (beam.events == 0) continue;
    if (is_pair(beam, scratch.changing)) {
      list_pair(beam, beliefs, scratch);
    } else {
      list_other(beam, scratch);
    }
  }
}

// inline: called for each beam that met something, and short.
inline void PatchBeamModel::list_pair(const ChangingBeam& beam, const Beliefs& beliefs,
                                      Scratch& scratch) const {
  const std::size_t log = beam.beam * scratch.lasers.padded() + beam.particle;
  const ChangingBeams::Event& last = scratch.changing.event(beam.last_event);
  const bool is_two = beam.events == 2;
  const ChangingBeams::Event& near = is_two ? scratch.changing.event(last.previous) : last;
  const std::size_t submap = to_place(near.ray.submap);
  const float* const own = beliefs.of(beam.particle).data() + states_.offset(submap);
  const double share = probability_of(near.ray.mask, own);
  const bool is_end = beam.is_ended && !is_two;
  scratch.share.push_back(is_end ? 1.0 : std::min(share, 1.0));
  scratch.first.push_back(near.log_likelihood);
  scratch.second.push_back(beam.is_ended ? last.log_likelihood : scratch.logs[log]);
  Pair& pair = scratch.pairs.emplace_back();
  pair.log = log;
  pair.particle = beam.particle;
  if (states_.memory() == PatchMemory::kNone) return;
  pair.near = near.ray.mask;
  pair.configurations = static_cast<std::uint32_t>(states_.count(submap));
  pair.row = scratch.said.meet(submap, pair.configurations, beam.particle);
}

/// Mixes the beams that end at one of two places, into their places of scratch.logs; with memory
/// what they say of a sub-map too.
void PatchBeamModel::mix_pairs(Scratch& scratch) const {
  scratch.mixed.resize(scratch.share.size());
  mix_logs(scratch.share.data(), scratch.first.data(), scratch.second.data(), scratch.share.size(),
           scratch.mixed.data());
  for (std::size_t n = 0; n < scratch.pairs.size(); ++n) {
    const Pair& pair = scratch.pairs[n];
    const double mixed = scratch.mixed[n];
    scratch.logs[pair.log] = mixed;
    const double near = scratch.first[n] - mixed;
    const double far = scratch.second[n] - mixed;
    for (std::uint32_t k = 0; k < pair.configurations; ++k) {
      scratch.said.at(pair.row + k, pair.particle) += (pair.near >> k & 1U) != 0 ? near : far;
    }
  }
}

void PatchBeamModel::list_other(const ChangingBeam& beam, Scratch& scratch) const {
  const std::size_t log = beam.beam * scratch.lasers.padded() + beam.particle;
  const OtherBeam other{log,
                        beam.particle,
                        scratch.events.size(),
                        scratch.value.size(),
                        to_place(beam.events),
                        scratch.met.size()};
  scratch.others.push_back(other);
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
}

/// The same for beams with any number of events, of any sub-maps: the recursion of SPEC C4 as it
/// stands.
void PatchBeamModel::mix_others(const Beliefs& beliefs, const ChunkStates& states,
                                Scratch& scratch) const {
  const bool has_memory = states_.memory() != PatchMemory::kNone;
  const auto met_by = [&](std::size_t n) {
    const std::size_t end =
        n + 1 < scratch.others.size() ? scratch.others[n + 1].met : scratch.met.size();
    return std::span(scratch.met).subspan(scratch.others[n].met, end - scratch.others[n].met);
  };
  exp_column(scratch.value.data(), scratch.value.size());
  scratch.mixed.clear();
  for (std::size_t n = 0; n < scratch.others.size(); ++n) {
    const OtherBeam& other = scratch.others[n];
    const auto events = std::span(scratch.events).subspan(other.event, other.events);
    const auto values = std::span(scratch.value).subspan(other.value, other.events);
    const double end_value = scratch.value[other.value + other.events];
    const std::span<const float> believed = beliefs.of(other.particle);
    const TwoEvents two(events, values, end_value, states_, believed);
    const auto mix = [&](int s, int k) {
      scratch.mixed.push_back(two.is_all()
                                  ? two.mixed(s, k)
                                  : mix_events(events, values, end_value, states_, believed, s, k));
    };
    mix(has_memory ? -1 : states.submap[other.particle],
        has_memory ? -1 : states.fixed(other.particle));
    for (const MetSubmap& met : met_by(n)) {
      for (int k = 0; k < states_.count(to_place(met.submap)); ++k) mix(met.submap, k);
    }
  }
  log_column(scratch.mixed.data(), scratch.mixed.size());
  const double* next = scratch.mixed.data();
  for (std::size_t n = 0; n < scratch.others.size(); ++n) {
    const OtherBeam& other = scratch.others[n];
    const double mixed = *next++;
    scratch.logs[other.log] = mixed;
    for (const MetSubmap& met : met_by(n)) {
      const auto configurations = to_place(states_.count(to_place(met.submap)));
      for (std::size_t k = 0; k < configurations; ++k) {
        scratch.said.at(met.row + k, other.particle) += *next++ - mixed;
      }
    }
  }
}

}  // namespace strata::localization
