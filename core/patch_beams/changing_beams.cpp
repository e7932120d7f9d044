// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/changing_beams.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace strata::patch_beams {

void ChangingBeams::Way::resize(std::size_t count) {
  if (of.size() >= count) return;  // all have at least as many
  for (std::vector<double>* numbers :
       {&bundle, &column, &row, &cosine, &sine, &from_m, &to_m, &skip, &boxes}) {
    if (numbers->size() < count) numbers->resize(2 * count);
  }
  of.resize(2 * count);
}

void ChangingBeams::Way::end(std::size_t count) {
  for (std::size_t k = count; k < count + rays::RayBatch::kSlack; ++k) {
    for (std::vector<double>* numbers : {&column, &row, &from_m, &to_m, &skip}) (*numbers)[k] = 0.0;
    cosine[k] = 1.0;
    sine[k] = 0.0;
  }
}

void ChangingBeams::Way::copy(std::size_t from, std::size_t to) {
  if (from == to) return;
  for (std::vector<double>* numbers : {&column, &row, &cosine, &sine, &to_m, &boxes}) {
    (*numbers)[to] = (*numbers)[from];
  }
  of[to] = of[from];
}

void ChangingBeams::find(const rays::BeamBundles& bundles, SeenBoxes& boxes,
                         const double* static_m) {
  max_range_m_ = bundles.max_range_m;
  event_count_ = 0;
  beams_.clear();
  single_.begin();
  if (boxes.empty()) return;
  for (std::size_t beam = 0; beam < bundles.beams; ++beam) {
    const std::span<const rays::BoxColumns> near =
        boxes.near_beam(bundles.cosine[beam], bundles.sine[beam]);
    if (near.empty()) continue;
    const std::size_t begin = beams_.size();
    way_.resize(begin + bundles.count + rays::BoxCrossings::kSlack);
    const std::size_t found = rays::cross_boxes(
        bundles, beam, static_m + beam * bundles.count, near,
        {way_.bundle.data() + begin, way_.cosine.data() + begin, way_.sine.data() + begin,
         way_.from_m.data() + begin, way_.to_m.data() + begin, way_.boxes.data() + begin},
        single_.rows(near.size() * bundles.count / rays::BeamBundles::kVector));
    beams_.resize(begin + found);
    for (std::size_t k = begin; k < begin + found; ++k) {
      const auto particle = static_cast<std::uint32_t>(way_.bundle[k]);
      way_.column[k] = bundles.column[particle];
      way_.row[k] = bundles.row[particle];
      way_.skip[k] = 0.0;
      way_.of[k] = static_cast<std::uint32_t>(k);
      beams_[k].beam = static_cast<std::uint32_t>(beam);
      beams_[k].particle = particle;
    }
  }
}

// inline below: called for each event, and short.

inline std::uint64_t ChangingBeams::ended(const ChangingBeam& beam, std::int32_t submap) const {
  std::uint64_t mask = 0;
  for (std::int32_t e = beam.last_event; e >= 0; e = event(e).previous) {
    if (event(e).ray.submap == submap) mask |= event(e).ray.mask;
  }
  return mask;
}

/// Whether ray k may come to a cell, in one of the boxes that it crosses, of a configuration that
/// counts and has not ended the beam yet. Those of `last` are known: `last_ended` have.
inline bool ChangingBeams::may_meet_more(const Round& round, std::size_t k, std::int32_t last,
                                         std::uint64_t last_ended) const {
  if (!round.boxes.are_named()) return true;
  const ChangingBeam& beam = beams_[way_.of[k]];
  for (auto left = static_cast<std::uint64_t>(way_.boxes[k]); left != 0; left &= left - 1) {
    const auto box = static_cast<std::size_t>(std::countr_zero(left));
    const CellOwner& cells = round.boxes.content(box, beam.particle);
    if (cells.submap < 0) return true;
    const bool is_last = cells.submap == last;
    if ((cells.mask & ~(is_last ? last_ended : ended(beam, cells.submap))) != 0) return true;
  }
  return false;
}

/// cells: the configurations that no earlier event of their sub-map, those of `before`, ended.
inline void ChangingBeams::add_event(ChangingBeam& beam, const CellOwner& cells, double range_m,
                                     bool is_known, std::uint64_t before, std::uint64_t all) {
  event_beam_[event_count_] = static_cast<double>(beam.beam);
  event_range_m_[event_count_] = range_m;
  events_[event_count_] = {{cells.submap, cells.mask, range_m}, 0.0, beam.last_event};
  beam.last_event = static_cast<std::int32_t>(event_count_++);
  ++beam.events;
  beam.is_ended = is_known || (before | cells.mask) == all;
}

/// Beams that met something in several uniform boxes, the nearest first.
void ChangingBeams::take_multiple(const Round& round) {
  single_.take_multiple([&](std::size_t beam, std::size_t bundle, std::size_t first,
                            std::size_t rows, std::size_t lane) {
    met_.clear();
    for (std::size_t n = first; n < first + rows; ++n) {
      if (std::isfinite(single_.range_m(n)[lane])) met_.emplace_back(single_.range_m(n)[lane], n);
    }
    std::sort(met_.begin(), met_.end());
    reserve_events(rows);
    ChangingBeam& taken = beams_.emplace_back();
    taken.beam = static_cast<std::uint32_t>(beam);
    taken.particle = static_cast<std::uint32_t>(bundle);
    for (const auto& [range_m, n] : met_) {
      const CellOwner& cells = round.boxes.content(single_.row(n).box, bundle);
      const std::uint64_t before = ended(taken, cells.submap);
      const std::uint64_t fresh = cells.mask & ~before;
      if (fresh == 0) continue;
      const bool is_known =
          cells.submap == round.states.submap[bundle] && round.states.fixed(bundle) >= 0;
      add_event(taken, {cells.submap, fresh}, range_m, is_known, before,
                round.caster.all(cells.submap));
      if (taken.is_ended) return;
    }
  });
}

/// Ray k has come to a marked cell: keeps the event, and the ray as number `on` when it goes on.
inline void ChangingBeams::meet(const Round& round, std::size_t k, std::size_t& on) {
  ChangingBeam& beam = beams_[way_.of[k]];
  const std::int32_t current = round.states.submap[beam.particle];
  const std::int32_t fixed = round.states.fixed(beam.particle);
  const CellOwner cell = round.caster.owner(mark_[k], current);
  const bool is_known = cell.submap == current && fixed >= 0;
  const std::uint64_t before = ended(beam, cell.submap);
  const std::uint64_t counts = PatchRayCaster::counting(cell.submap, current, fixed);
  const std::uint64_t fresh = cell.mask & ~before & counts;
  if (fresh != 0) {
    add_event(beam, {cell.submap, fresh}, range_m_[k], is_known, before,
              round.caster.all(cell.submap));
    if (beam.is_ended) return;
  }
  if (!may_meet_more(round, k, cell.submap, before | fresh)) return;
  way_.copy(k, on);
  // From the middle of this cell on, through others like it.
  way_.from_m[on] = range_m_[k];
  way_.skip[on] = static_cast<double>(mark_[k]);
  ++on;
}

void ChangingBeams::reserve_events(std::size_t more) {
  if (events_.size() >= event_count_ + more) return;
  events_.resize(2 * (event_count_ + more));
  event_beam_.resize(events_.size());
  event_range_m_.resize(events_.size());
  event_log_.resize(events_.size());
}

void ChangingBeams::follow(const PatchRayCaster& caster, const rays::BeamBundles& bundles,
                           const SeenBoxes& boxes, const ChunkStates& states,
                           const rays::ScanMixture& mixture) {
  single_.cast(caster.changing_table(), bundles);
  std::size_t left = beams_.size();
  range_m_.resize(std::max(range_m_.size(), left + rays::RayBatch::kSlack));
  mark_.resize(std::max(mark_.size(), left + rays::RayBatch::kSlack));
  while (left > 0) {
    way_.end(left);
    caster.cast_changing(
        {way_.column.data(), way_.row.data(), way_.cosine.data(), way_.sine.data(),
         way_.from_m.data(), way_.to_m.data(), way_.skip.data(), left, max_range_m_},
        range_m_.data(), mark_.data());
    reserve_events(left);
    std::size_t on = 0;
    for (std::size_t k = 0; k < left; ++k) {
      if (mark_[k] > 0) meet({caster, boxes, states}, k, on);
    }
    left = on;
  }
  take_multiple({caster, boxes, states});
  mixture.log_likelihoods_of(event_beam_.data(), event_count_, event_range_m_.data(),
                             event_log_.data());
  for (std::size_t e = 0; e < event_count_; ++e) events_[e].log_likelihood = event_log_[e];
}

}  // namespace strata::patch_beams
