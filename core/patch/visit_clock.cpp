// SPDX-License-Identifier: Apache-2.0
#include "core/patch/visit_clock.hpp"

#include <algorithm>

namespace strata::patch {
namespace {

/// For so long a state may be interrupted: by people who walk by, by a few stray readings.
constexpr double kInterruption_s = 2.0;
constexpr float kLeastLead = 4.0F;
/// What shows a state clearly, as in the test for few visits.
constexpr double kOccupiedShare = 0.6;
constexpr double kFreeShare = 0.1;
constexpr double kLeastBeams = 3.0;

bool is_clear(const Visit& visit, bool occupied) {
  const auto hits = static_cast<double>(visit.hits);
  const double total = visit.total();
  return total >= kLeastBeams &&
         (occupied ? hits >= kOccupiedShare * total : hits <= kFreeShare * total);
}

}  // namespace

void VisitClock::advance(int run, Stamp stamp, std::uint32_t scan) {
  if (run_ != run) {
    recent_.clear();
    young_.clear();
    settled_before_ = 0;
    run_ = run;
  }
  while (!recent_.empty() && (stamp - recent_.front().second).seconds() > config_.gap_s) {
    recent_.pop_front();
  }
  recent_.emplace_back(scan, stamp);
  joins_from_ = recent_.front().first;
  if (config_.min_state_s <= 0.0) return;
  while (!young_.empty() && (stamp - young_.front().second).seconds() >= config_.min_state_s) {
    settled_before_ = young_.front().first + 1;
    young_.pop_front();
  }
  young_.emplace_back(scan, stamp);
}

bool VisitClock::speaks_against(const Visit& visit, bool is_hit) {
  return is_clear(visit, !is_hit);
}

float VisitClock::most_lead(const Visit& visit, std::uint32_t now) const {
  const double scans = config_.min_state_s > 0.0 ? static_cast<double>(young_.size()) *
                                                       kInterruption_s / config_.min_state_s
                                                 : 0.0;
  const double beams_per_scan = visit.total() / static_cast<double>(now - visit.first_scan + 1);
  return std::max(kLeastLead, static_cast<float>(scans * beams_per_scan));
}

bool VisitClock::is_change(const Visit& before, const Visit& after) {
  return (is_clear(before, true) && is_clear(after, false)) ||
         (is_clear(before, false) && is_clear(after, true));
}

}  // namespace strata::patch
