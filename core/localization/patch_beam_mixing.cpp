// SPDX-License-Identifier: Apache-2.0
// What the beams that met changing cells say of the particle and of the sub-maps.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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
  TwoEvents(const std::vector<RayEvent>& events, const std::vector<double>& values,
            double end_value, const PatchStates& states, std::span<const float> belief)
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

  const std::vector<RayEvent>& events_;
  const std::vector<double>& values_;
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

/// Mixes, for all particles at once, the beams that end at one of two places.
void PatchBeamModel::mix_pairs(const ParticleSet& particles, std::size_t begin, std::size_t end,
                               Scratch& scratch) const {
  const std::size_t beams = scratch.static_m.size();
  scratch.share.clear();
  scratch.first.clear();
  scratch.second.clear();
  for (std::size_t i = begin; i < end; ++i) {
    const std::span<const float> row = belief(particles, i);
    for (const ChangingBeam& beam : scratch.changing.beams(i - begin)) {
      if (!is_pair(beam, scratch.changing)) continue;
      const ChangingBeams::Event& last = scratch.changing.event(beam.last_event);
      if (beam.events == 1 && beam.is_ended) {
        scratch.share.push_back(1.0);
        scratch.first.push_back(last.log_likelihood);
        scratch.second.push_back(last.log_likelihood);
        continue;
      }
      const bool is_two = beam.events == 2;
      const ChangingBeams::Event& near = is_two ? scratch.changing.event(last.previous) : last;
      const float* const own = row.data() + states_.offset(to_place(near.ray.submap));
      double share = 0.0;
      for (std::uint64_t left = near.ray.mask; left != 0; left &= left - 1) {
        share += static_cast<double>(own[std::countr_zero(left)]);
      }
      scratch.share.push_back(std::min(share, 1.0));
      scratch.first.push_back(near.log_likelihood);
      scratch.second.push_back(is_two ? last.log_likelihood
                                      : scratch.logs[(i - begin) * beams + beam.beam]);
    }
  }
  scratch.mixed.resize(scratch.share.size());
  mix_logs(scratch.share.data(), scratch.first.data(), scratch.second.data(), scratch.share.size(),
           scratch.mixed.data());
}

void PatchBeamModel::touch(std::int32_t submap, Scratch& scratch) const {
  if (std::find(scratch.touched.begin(), scratch.touched.end(), submap) != scratch.touched.end()) {
    return;
  }
  scratch.touched.push_back(submap);
  const std::size_t offset = states_.offset(to_place(submap));
  for (int k = 0; k < states_.count(to_place(submap)); ++k) {
    scratch.log_ratio[offset + to_place(k)] = 0.0;
  }
}

/// Any number of events, of any sub-maps: the recursion of SPEC C4 as it stands.
double PatchBeamModel::mix_many(const ParticleSet& particles, std::size_t i,
                                const ChangingBeam& beam, double log_static,
                                Scratch& scratch) const {
  scratch.events.resize(to_place(beam.events));
  scratch.values.resize(to_place(beam.events));
  std::int32_t place = beam.last_event;
  for (std::size_t e = scratch.events.size(); e-- > 0;) {
    const ChangingBeams::Event& event = scratch.changing.event(place);
    scratch.events[e] = event.ray;
    scratch.values[e] = std::exp(event.log_likelihood);
    place = event.previous;
  }
  const double end_value = std::exp(log_static);
  const std::span<const float> row = belief(particles, i);
  const TwoEvents two(scratch.events, scratch.values, end_value, states_, row);
  const auto log_mixed = [&](int s, int k) {
    if (two.is_all()) return std::log(two.mixed(s, k));
    return std::log(mix_events(scratch.events, scratch.values, end_value, states_, row, s, k));
  };
  if (states_.memory() == PatchMemory::kNone) {
    return log_mixed(particles.submap[i], particles.patch[i]);
  }
  const double mixed = log_mixed(-1, -1);
  for (std::size_t e = 0; e < scratch.events.size(); ++e) {
    const std::int32_t s = scratch.events[e].submap;
    bool is_first = true;
    for (std::size_t f = 0; f < e; ++f) is_first = is_first && scratch.events[f].submap != s;
    if (!is_first) continue;
    touch(s, scratch);
    const std::size_t offset = states_.offset(to_place(s));
    for (int k = 0; k < states_.count(to_place(s)); ++k) {
      scratch.log_ratio[offset + to_place(k)] += log_mixed(s, k) - mixed;
    }
  }
  return mixed;
}

/// The changing beams of particle i, the n-th of the chunk, into its row of logs; with memory
/// log_ratio and touched too. pair: how many of mix_pairs are done.
void PatchBeamModel::mix_beams(const ParticleSet& particles, std::size_t i, std::size_t n,
                               double* logs, std::size_t& pair, Scratch& scratch) const {
  scratch.touched.clear();
  for (const ChangingBeam& beam : scratch.changing.beams(n)) {
    if (beam.events == 0) continue;
    if (!is_pair(beam, scratch.changing)) {
      logs[beam.beam] = mix_many(particles, i, beam, logs[beam.beam], scratch);
      continue;
    }
    const double mixed = scratch.mixed[pair];
    logs[beam.beam] = mixed;
    if (states_.memory() != PatchMemory::kNone) {
      std::int32_t place = beam.last_event;
      if (beam.events == 2) place = scratch.changing.event(place).previous;
      const RayEvent& near = scratch.changing.event(place).ray;
      touch(near.submap, scratch);
      const std::size_t offset = states_.offset(to_place(near.submap));
      for (int k = 0; k < states_.count(to_place(near.submap)); ++k) {
        const bool is_there = (near.mask >> k & 1U) != 0;
        scratch.log_ratio[offset + to_place(k)] +=
            (is_there ? scratch.first[pair] : scratch.second[pair]) - mixed;
      }
    }
    ++pair;
  }
}

/// Scan-level mixture over the configurations of the particle's own sub-map.
double PatchBeamModel::own_mixture(std::span<const float> belief, int current,
                                   const Scratch& scratch) const {
  if (std::find(scratch.touched.begin(), scratch.touched.end(), current) == scratch.touched.end()) {
    return 0.0;
  }
  const auto s = static_cast<std::size_t>(current);
  const std::size_t offset = states_.offset(s);
  const auto count = static_cast<std::size_t>(states_.count(s));
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < count; ++k) {
    largest = std::max(largest, scratch.log_ratio[offset + k]);
  }
  double total = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    total +=
        static_cast<double>(belief[offset + k]) * std::exp(scratch.log_ratio[offset + k] - largest);
  }
  return largest + std::log(total);
}

/// What the scan says of the sub-maps that it touched, into the particle's row; returns the
/// logarithm of what its own sub-map adds to the weight.
double PatchBeamModel::remember(double tempering, ParticleSet& particles, std::size_t i,
                                Scratch& scratch) const {
  const bool is_shared = states_.memory() == PatchMemory::kShared;
  const int current = particles.submap[i];
  for (const std::int32_t s : scratch.touched) {
    const std::size_t offset = states_.offset(to_place(s));
    for (int k = 0; k < states_.count(to_place(s)); ++k) {
      scratch.log_ratio[offset + to_place(k)] /= tempering;
    }
  }
  const double own = own_mixture(belief(particles, i), current, scratch);
  const std::span<float> row = particles.belief(i);
  if (is_shared) std::fill(row.begin(), row.end(), 1.0F);
  for (const std::int32_t s : scratch.touched) {
    const std::size_t offset = states_.offset(to_place(s));
    const auto count = static_cast<std::size_t>(states_.count(to_place(s)));
    for (std::size_t k = 0; k < count; ++k) {
      // What absorb() sums: p(z | x_i, m_s = k) over the particle's own likelihood, in which the
      // mixture over its own sub-map counts once.
      const double ratio = scratch.log_ratio[offset + k] - (s == current ? own : 0.0);
      const double factor = std::exp(std::min(80.0, ratio));
      if (is_shared) row[offset + k] = static_cast<float>(factor);
      scratch.factor[k] = factor;
    }
    if (!is_shared) {
      update_belief(row.subspan(offset, count), {scratch.factor.data(), count},
                    states_.least_belief());
    }
  }
  return own;
}

}  // namespace strata::localization
