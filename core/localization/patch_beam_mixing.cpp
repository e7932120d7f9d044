// SPDX-License-Identifier: Apache-2.0
// What the beams that met changing cells say of the particle and of the sub-maps.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/localization/column_math.hpp"
#include "core/localization/patch_beam_model.hpp"

namespace strata::localization {
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
      for (std::uint64_t left = events[e].mask; left != 0; left &= left - 1) {
        probability_[e] += static_cast<double>(own[std::countr_zero(left)]);
      }
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

std::span<const float> PatchBeamModel::belief(const ParticleSet& particles, std::size_t i) const {
  switch (states_.memory()) {
    case PatchMemory::kNone:
      return states_.uniform();
    case PatchMemory::kShared:
      return particles.shared_belief;
    case PatchMemory::kPerParticle:
      break;
  }
  return particles.belief(i);
}

// inline below: called for each beam that met something, and short.

/// Where the ratios of a sub-map's configurations begin that beams of the last particle of
/// said_begins met.
inline std::size_t PatchBeamModel::ratios(std::int32_t submap, Scratch& scratch) const {
  std::vector<Said>& said = scratch.said;
  for (std::size_t n = said.size(); n > scratch.said_begins.back(); --n) {
    if (said[n - 1].submap == submap) return said[n - 1].ratios;
  }
  said.push_back({submap, scratch.ratio.size()});
  scratch.ratio.resize(scratch.ratio.size() + to_place(states_.count(to_place(submap))), 0.0);
  return said.back().ratios;
}

/// Lists the beams of all particles that met something.
void PatchBeamModel::list_beams(const ParticleSet& particles, std::size_t begin, std::size_t end,
                                Scratch& scratch) const {
  for (auto* list : {&scratch.share, &scratch.first, &scratch.second, &scratch.ratio})
    list->clear();
  scratch.pairs.clear();
  scratch.others.clear();
  scratch.events.clear();
  scratch.value.clear();
  scratch.met.clear();
  scratch.said.clear();
  scratch.said_begins.clear();
  std::size_t row = 0;
  for (std::size_t i = begin; i < end; ++i, row += scratch.static_m.size()) {
    const std::span<const float> believed = belief(particles, i);
    scratch.said_begins.push_back(scratch.said.size());
    for (const ChangingBeam& beam : scratch.changing.beams(i - begin)) {
      if (beam.events == 0) continue;
      if (is_pair(beam, scratch.changing)) {
        list_pair(beam, row + beam.beam, believed, scratch);
      } else {
        list_other(beam, row + beam.beam, i, scratch);
      }
    }
  }
  scratch.said_begins.push_back(scratch.said.size());
}

inline void PatchBeamModel::list_pair(const ChangingBeam& beam, std::size_t log,
                                      std::span<const float> believed, Scratch& scratch) const {
  const ChangingBeams::Event& last = scratch.changing.event(beam.last_event);
  const bool is_two = beam.events == 2;
  const ChangingBeams::Event& near = is_two ? scratch.changing.event(last.previous) : last;
  const std::size_t submap = to_place(near.ray.submap);
  const float* const own = believed.data() + states_.offset(submap);
  double share = 0.0;
  for (std::uint64_t left = near.ray.mask; left != 0; left &= left - 1) {
    share += static_cast<double>(own[std::countr_zero(left)]);
  }
  const bool is_end = beam.is_ended && !is_two;
  scratch.share.push_back(is_end ? 1.0 : std::min(share, 1.0));
  scratch.first.push_back(near.log_likelihood);
  scratch.second.push_back(beam.is_ended ? last.log_likelihood : scratch.logs[log]);
  const bool has_memory = states_.memory() != PatchMemory::kNone;
  scratch.pairs.push_back({log, near.ray.mask, has_memory ? ratios(near.ray.submap, scratch) : 0,
                           has_memory ? states_.count(submap) : 0});
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
    double* const ratio = scratch.ratio.data() + pair.ratios;
    for (int k = 0; k < pair.configurations; ++k)
      ratio[k] += (pair.near >> k & 1U) != 0 ? near : far;
  }
}

void PatchBeamModel::list_other(const ChangingBeam& beam, std::size_t log, std::size_t particle,
                                Scratch& scratch) const {
  const OtherBeam other{log,
                        particle,
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
    const auto is_same = [&](const Said& met) { return met.submap == submap; };
    const auto first = scratch.met.begin() + static_cast<std::ptrdiff_t>(other.met);
    if (std::any_of(first, scratch.met.end(), is_same)) continue;
    scratch.met.push_back({submap, ratios(submap, scratch)});
  }
}

/// The same for beams with any number of events, of any sub-maps: the recursion of SPEC C4 as it
/// stands.
void PatchBeamModel::mix_others(const ParticleSet& particles, Scratch& scratch) const {
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
    const std::span<const float> believed = belief(particles, other.particle);
    const TwoEvents two(events, values, end_value, states_, believed);
    const auto mix = [&](int s, int k) {
      scratch.mixed.push_back(two.is_all()
                                  ? two.mixed(s, k)
                                  : mix_events(events, values, end_value, states_, believed, s, k));
    };
    mix(has_memory ? -1 : particles.submap[other.particle],
        has_memory ? -1 : particles.patch[other.particle]);
    for (const Said& met : met_by(n)) {
      for (int k = 0; k < states_.count(to_place(met.submap)); ++k) mix(met.submap, k);
    }
  }
  log_column(scratch.mixed.data(), scratch.mixed.size());
  const double* next = scratch.mixed.data();
  for (std::size_t n = 0; n < scratch.others.size(); ++n) {
    const double mixed = *next++;
    scratch.logs[scratch.others[n].log] = mixed;
    for (const Said& met : met_by(n)) {
      double* const ratio = scratch.ratio.data() + met.ratios;
      for (int k = 0; k < states_.count(to_place(met.submap)); ++k) ratio[k] += *next++ - mixed;
    }
  }
}

/// What the scan says of the sub-maps that beams of the chunk met, into the rows of its particles;
/// their log-likelihoods get what their own sub-maps add: the mixture over its configurations for
/// the scan as a whole.
void PatchBeamModel::remember(double tempering, ParticleSet& particles, std::size_t begin,
                              std::size_t end, std::span<double> log_likelihood,
                              Scratch& scratch) const {
  const auto said_of = [&](std::size_t i) {
    const std::size_t first = scratch.said_begins[i - begin];
    return std::span(scratch.said).subspan(first, scratch.said_begins[i - begin + 1] - first);
  };
  const auto ratio_of = [&](const Said& said) {
    return std::span(scratch.ratio)
        .subspan(said.ratios, to_place(states_.count(to_place(said.submap))));
  };
  for (std::size_t i = begin; i < end; ++i) {
    for (const Said& said : said_of(i)) {
      const std::span<double> ratio = ratio_of(said);
      for (double& r : ratio) r /= tempering;
      double largest = 0.0;
      if (said.submap == particles.submap[i]) {
        largest = *std::max_element(ratio.begin(), ratio.end());
        log_likelihood[i] += largest;
      }
      for (double& r : ratio) r = std::min(80.0, r - largest);
    }
  }
  exp_column(scratch.ratio.data(), scratch.ratio.size());
  const bool is_shared = states_.memory() == PatchMemory::kShared;
  for (std::size_t i = begin; i < end; ++i) {
    const std::span<float> row = particles.belief(i);
    if (is_shared) std::fill(row.begin(), row.end(), 1.0F);
    for (const Said& said : said_of(i)) {
      const std::span<const double> factor = ratio_of(said);
      const std::size_t offset = states_.offset(to_place(said.submap));
      double own = 1.0;
      if (said.submap == particles.submap[i]) {
        const float* const believed = belief(particles, i).data() + offset;
        own = std::inner_product(factor.begin(), factor.end(), believed, 0.0);
        log_likelihood[i] += std::log(own);
      }
      if (!is_shared) {
        update_belief(row.subspan(offset, factor.size()), factor, states_.least_belief());
        continue;
      }
      // What absorb() sums: p(z | x_i, m_s = k) over the particle's own likelihood, in which the
      // mixture over its own sub-map counts once.
      for (std::size_t k = 0; k < factor.size(); ++k) {
        row[offset + k] = static_cast<float>(factor[k] / own);
      }
    }
  }
}

}  // namespace strata::localization
