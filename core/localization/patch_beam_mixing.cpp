// SPDX-License-Identifier: Apache-2.0
// What the beams that met changing cells say of the particle and of the sub-maps.
#include <algorithm>

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

/// The probability that the cells of each uniform box are there, for each particle that it counts
/// for.
void PatchBeamModel::share_boxes(const Beliefs& beliefs, const ChunkStates& states,
                                 Scratch& scratch) const {
  const SeenBoxes& boxes = scratch.boxes;
  const std::size_t row = boxes.lasers();
  const bool has_memory = states_.memory() != PatchMemory::kNone;
  scratch.box_share.resize(boxes.size() * row);
  for (std::size_t box = 0; box < boxes.size(); ++box) {
    if (!boxes.is_uniform(box)) continue;
    double* const share = scratch.box_share.data() + box * row;
    for (std::size_t n = 0; n < scratch.lasers.count(); ++n) {
      if (!boxes.counts(box, n)) continue;
      const CellOwner& cells = boxes.content(box, n);
      const bool is_own = cells.submap == states.submap[n];
      const bool is_known = is_own && states.fixed(n) >= 0;
      if (is_known || cells.mask == caster_.all(cells.submap)) {
        share[n] = 1.0;
      } else if (is_own && has_memory) {
        share[n] = SingleBeams::kApart;
      } else {
        const float* const own = beliefs.of(n).data() + states_.offset(to_place(cells.submap));
        share[n] = std::min(1.0, probability_of(cells.mask, own));
      }
    }
  }
}

/// Mixes the beams that ChangingBeams keeps apart. Those that met the particle's own sub-map are
/// not mixed one by one with memory: remember() weighs its configurations for the scan as a whole.
void PatchBeamModel::mix_single(const ScanMixture& mixture, const Beliefs& beliefs,
                                const ChunkStates& states, Scratch& scratch) const {
  const SeenBoxes& boxes = scratch.boxes;
  SingleBeams& single = scratch.changing.single();
  const std::size_t row = boxes.lasers();
  scratch.single_log.assign(scratch.lasers.padded(), 0.0);
  if (single.size() == 0) return;
  share_boxes(beliefs, states, scratch);
  const bool has_memory = states_.memory() != PatchMemory::kNone;
  single.mix(mixture, row, scratch.box_share, has_memory, scratch.logs.data());
  const SingleBeams::Sums& sums = single.sums();
  for (std::size_t box = 0; box < boxes.size(); ++box) {
    if (!boxes.is_uniform(box)) continue;
    std::int32_t submap = -1;  // of the particle before
    std::size_t place = 0;
    for (std::size_t n = 0; n < scratch.lasers.count(); ++n) {
      const std::size_t at = box * row + n;
      if (sums.beams[at] == 0.0) continue;
      scratch.single_log[n] += sums.mixed[at];
      if (!has_memory) continue;
      const CellOwner& cells = boxes.content(box, n);
      if (cells.submap != submap) {
        submap = cells.submap;
        place = scratch.said.place_of(to_place(submap), to_place(states_.count(to_place(submap))));
      }
      scratch.said.meet_again(place, n);
      const SubmapRatios::Met& met = scratch.said.met()[place];
      for (std::size_t k = 0; k < met.configurations; ++k) {
        scratch.said.at(met.row + k, n) +=
            (cells.mask >> k & 1U) != 0 ? sums.near[at] : sums.far[at];
      }
    }
  }
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

}  // namespace strata::localization
