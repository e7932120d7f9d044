// SPDX-License-Identifier: Apache-2.0
#include "core/localization/changing_beams.hpp"

#include <algorithm>
#include <bit>

namespace strata::localization {

void ChangingBeams::Way::resize(std::size_t count) {
  for (std::vector<double>* numbers :
       {&beam, &column, &row, &cosine, &sine, &from_m, &to_m, &skip, &boxes}) {
    if (numbers->size() < count) numbers->resize(2 * count);
  }
  if (of.size() < count) of.resize(2 * count);
}

void ChangingBeams::Way::copy(std::size_t from, std::size_t to) {
  if (from == to) return;
  for (std::vector<double>* numbers : {&beam, &column, &row, &cosine, &sine, &to_m, &boxes}) {
    (*numbers)[to] = (*numbers)[from];
  }
  of[to] = of[from];
}

void ChangingBeams::begin() {
  rays_ = 0;
  beams_.clear();
  particle_.clear();
  seen_.clear();
  begins_.assign(1, 0);
  event_count_ = 0;
  boxes_.clear();
}

void ChangingBeams::add(const PatchRayCaster& caster, const RayFan& fan, const double* static_m,
                        std::span<const RayBox> boxes, int current, int fixed) {
  max_range_m_ = fan.max_range_m;
  std::size_t found = 0;
  if (!boxes.empty()) {
    way_.resize(rays_ + fan.count + RayCrossings::kSlack);
    found = cross_boxes(
        fan, static_m, boxes.data(), boxes.size(),
        {way_.beam.data() + rays_, way_.cosine.data() + rays_, way_.sine.data() + rays_,
         way_.from_m.data() + rays_, way_.to_m.data() + rays_, way_.boxes.data() + rays_});
  }
  beams_.resize(rays_ + found);
  particle_.resize(rays_ + found, static_cast<std::uint32_t>(seen_.size()));
  const RayTable table = caster.changing_table();
  const double column = table.column_at(fan.x_m);
  const double row = table.row_at(fan.y_m);
  for (std::size_t k = rays_; k < rays_ + found; ++k) {
    way_.column[k] = column;
    way_.row[k] = row;
    way_.skip[k] = 0.0;
    way_.of[k] = static_cast<std::uint32_t>(k);
    beams_[k].beam = static_cast<std::uint32_t>(way_.beam[k]);
  }
  seen_.push_back({current, fixed, boxes_.size(), boxes.size() <= RayCrossings::kNamed});
  for (const RayBox& box : boxes) {
    const std::span<const CellOwner> owners = caster.owners_in(box, current);
    boxes_.push_back(owners.size() == 1 ? owners.front() : CellOwner{});
    boxes_.back().mask &= PatchRayCaster::counting(boxes_.back().submap, current, fixed);
  }
  rays_ += found;
  begins_.push_back(rays_);
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
inline bool ChangingBeams::may_meet_more(std::size_t k, const Seen& seen, std::int32_t last,
                                         std::uint64_t last_ended) const {
  if (!seen.is_named) return true;
  const ChangingBeam& beam = beams_[way_.of[k]];
  for (auto left = static_cast<std::uint64_t>(way_.boxes[k]); left != 0; left &= left - 1) {
    const auto box = static_cast<std::size_t>(std::countr_zero(left));
    const CellOwner& cells = boxes_[seen.first_box + box];
    const bool is_last = cells.submap == last;
    if (cells.submap < 0) return true;
    if ((cells.mask & ~(is_last ? last_ended : ended(beam, cells.submap))) != 0) return true;
  }
  return false;
}

/// Ray k has come to a marked cell: keeps the event, and the ray as number `on` when it goes on.
inline void ChangingBeams::meet(const PatchRayCaster& caster, std::size_t k, std::size_t& on) {
  const std::uint32_t of = way_.of[k];
  ChangingBeam& beam = beams_[of];
  const Seen& seen = seen_[particle_[of]];
  const CellOwner cell = caster.owner(mark_[k], seen.current);
  const bool is_known = cell.submap == seen.current && seen.fixed >= 0;
  const std::uint64_t before = ended(beam, cell.submap);
  const std::uint64_t counts = PatchRayCaster::counting(cell.submap, seen.current, seen.fixed);
  const std::uint64_t fresh = cell.mask & ~before & counts;
  if (fresh != 0) {
    event_beam_[event_count_] = way_.beam[k];
    event_range_m_[event_count_] = range_m_[k];
    events_[event_count_] = {{cell.submap, fresh, range_m_[k]}, 0.0, beam.last_event};
    beam.last_event = static_cast<std::int32_t>(event_count_++);
    ++beam.events;
    beam.is_ended = is_known || (before | fresh) == caster.all(cell.submap);
    if (beam.is_ended) return;
  }
  if (!may_meet_more(k, seen, cell.submap, before | fresh)) return;
  way_.copy(k, on);
  // From the middle of this cell on, through others like it.
  way_.from_m[on] = range_m_[k];
  way_.skip[on] = static_cast<double>(mark_[k]);
  ++on;
}

void ChangingBeams::follow(const PatchRayCaster& caster, const ScanMixture& mixture) {
  range_m_.resize(std::max(range_m_.size(), rays_));
  mark_.resize(std::max(mark_.size(), rays_));
  std::size_t left = rays_;
  while (left > 0) {
    caster.cast_changing(
        {way_.column.data(), way_.row.data(), way_.cosine.data(), way_.sine.data(),
         way_.from_m.data(), way_.to_m.data(), way_.skip.data(), left, max_range_m_},
        range_m_.data(), mark_.data());
    if (events_.size() < event_count_ + left) {
      events_.resize(2 * (event_count_ + left));
      event_beam_.resize(events_.size());
      event_range_m_.resize(events_.size());
      event_log_.resize(events_.size());
    }
    std::size_t on = 0;
    for (std::size_t k = 0; k < left; ++k) {
      if (mark_[k] > 0) meet(caster, k, on);
    }
    left = on;
  }
  mixture.log_likelihoods_of(event_beam_.data(), event_count_, event_range_m_.data(),
                             event_log_.data());
  for (std::size_t e = 0; e < event_count_; ++e) events_[e].log_likelihood = event_log_[e];
}

}  // namespace strata::localization
