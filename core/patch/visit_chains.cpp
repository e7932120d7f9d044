// SPDX-License-Identifier: Apache-2.0
#include "core/patch/visit_chains.hpp"

#include <algorithm>

namespace strata::patch {
namespace {

bool is_occupied_in(const Visit& visit) { return visit.hits >= visit.misses; }

/// What the later visit saw counts for the one before.
void join(Visit& before, const Visit& after) {
  before.last_scan = after.last_scan;
  before.hits += after.hits;
  before.misses += after.misses;
  before.passing.cos2 += after.passing.cos2;
  before.passing.sin2 += after.passing.sin2;
  before.bound();
}

}  // namespace

void VisitChains::begin(std::int32_t& newest, std::uint32_t scan, float lead_of) {
  std::int32_t fresh = free_;
  if (fresh < 0) {
    fresh = static_cast<std::int32_t>(nodes_.size());
    leads_.push_back(kNotOnTrial);
    try {
      nodes_.emplace_back();
    } catch (...) {
      leads_.pop_back();  // one each
      throw;
    }
  } else {
    free_ = node(fresh).previous;
  }
  node(fresh) = {Visit{scan, scan, 0.0F, 0.0F, {}}, newest};
  lead(fresh) = lead_of;
  newest = fresh;
}

void VisitChains::free(std::int32_t i) {
  node(i) = {Visit{}, free_};
  lead(i) = kNotOnTrial;
  free_ = i;
}

void VisitChains::end_trial(std::int32_t& newest) {
  if (newest < 0 || !is_on_trial(newest)) return;
  const std::int32_t before = node(newest).previous;
  join(node(before).visit, node(newest).visit);
  lead(before) = kNotOnTrial;
  free(newest);
  newest = before;
}

bool VisitChains::add(std::int32_t& newest, const VisitClock& clock, std::uint32_t scan,
                      bool is_hit, float amount, const BeamAxis& axis) {
  bool is_more = false;
  if (newest < 0 || !clock.goes_on(node(newest).visit)) {
    end_trial(newest);
    begin(newest, scan, kNotOnTrial);
    is_more = true;
  } else if (!is_on_trial(newest) && VisitClock::speaks_against(node(newest).visit, is_hit)) {
    const std::int32_t before = newest;
    begin(newest, scan, 0.0F);
    if (!clock.is_settled(node(before).visit)) lead(before) = kBrief;
  }
  Visit& visit = node(newest).visit;
  visit.last_scan = scan;
  visit.add(is_hit, amount, axis);
  if (!is_on_trial(newest)) return is_more;
  const bool was_occupied = is_occupied_in(node(node(newest).previous).visit);
  lead(newest) += is_hit == was_occupied ? -amount : amount;
  return judge(newest, clock, scan);
}

bool VisitChains::judge(std::int32_t& newest, const VisitClock& clock, std::uint32_t scan) {
  const Visit& visit = node(newest).visit;
  float& so_far = lead(newest);
  if (so_far < 0.0F) {
    so_far = 0.0F;
    end_trial(newest);
    return false;
  }
  so_far = std::min(so_far, clock.most_lead(visit, scan));
  if (!clock.is_settled(visit)) return false;
  const std::int32_t before = node(newest).previous;
  if (!VisitClock::is_change(node(before).visit, visit)) {
    end_trial(newest);
    return false;
  }
  so_far = kNotOnTrial;
  if (lead(before) != kBrief) return true;
  node(newest).previous = node(before).previous;
  free(before);
  return false;
}

void VisitChains::forget_surplus(std::int32_t newest, int most) {
  if (newest >= 0 && is_on_trial(newest)) newest = node(newest).previous;
  int count = 0;
  int occupied = 0;
  for (std::int32_t n = newest; n >= 0; n = node(n).previous) {
    ++count;
    if (n != newest && is_occupied_in(node(n).visit)) ++occupied;
  }
  for (; count > most; --count) {
    const bool drops_occupied = 2 * occupied >= count - 1;
    std::int32_t after = -1;  // the node whose previous one goes
    for (std::int32_t n = newest; node(n).previous >= 0; n = node(n).previous) {
      if (is_occupied_in(node(node(n).previous).visit) == drops_occupied) after = n;
    }
    const std::int32_t gone = node(after).previous;
    node(after).previous = node(gone).previous;
    free(gone);
    if (drops_occupied) --occupied;
  }
}

void VisitChains::collect(std::int32_t newest, std::vector<Visit>& visits) const {
  if (newest < 0) return;
  const auto begin = static_cast<std::ptrdiff_t>(visits.size());
  for (std::int32_t n = newest; n >= 0; n = node(n).previous) visits.push_back(node(n).visit);
  std::reverse(visits.begin() + begin, visits.end());
  if (!is_on_trial(newest)) return;
  const Visit last = visits.back();
  visits.pop_back();
  join(visits.back(), last);
}

bool VisitChains::reaches_new(std::int32_t list, std::vector<bool>& is_reached) const {
  std::int32_t i = list;
  for (; i >= 0; i = node(i).previous) {
    const auto n = static_cast<std::size_t>(i);
    if (n >= nodes_.size() || is_reached[n]) return false;
    is_reached[n] = true;
    if (!is_on_trial(i)) continue;
    if (i != list || node(i).previous < 0) return false;
  }
  return i == -1;
}

}  // namespace strata::patch
