// SPDX-License-Identifier: Apache-2.0
#include "core/patch/sequence_history.hpp"

#include <algorithm>
#include <cmath>

#include "core/periodic/periodic_shares.hpp"

namespace strata::patch {
namespace {

bool are_alike(const Transition& a, const Transition& b) {
  return a.from == b.from && a.to == b.to && a.hour == b.hour &&
         std::ilogb(a.dt_s) == std::ilogb(b.dt_s);
}

}  // namespace

void SequenceHistory::add_transition(const Transition& transition) {
  const auto alike =
      std::find_if(transitions_.begin(), transitions_.end(),
                   [&](const Transition& other) { return are_alike(other, transition); });
  if (alike == transitions_.end()) {
    transitions_.push_back(transition);
    return;
  }
  const double count = alike->count + transition.count;
  alike->dt_s = (alike->count * alike->dt_s + transition.count * transition.dt_s) / count;
  alike->count = count;
}

/// Sequences come in order of time, but for those of runs whose stamps overlap.
void SequenceHistory::see(Stamp begin) {
  const std::int64_t day = periodic::day_of(begin);
  if (seen_.days > 0 && day <= seen_.newest_day) return;
  if (seen_.days == 0 || periodic::week_of_day(day) > periodic::week_of_day(seen_.newest_day)) {
    ++seen_.weeks;
  }
  ++seen_.days;
  seen_.newest_day = day;
}

void SequenceHistory::append(double dt_s, Stamp begin) {
  counts_.push_back(1.0);
  if (counts_.size() > 1 && dt_s > 0.0 && std::isfinite(dt_s)) {
    // New entries have no transitions yet: nothing to look for.
    const auto to = static_cast<std::uint32_t>(counts_.size() - 1);
    try {
      transitions_.push_back({to - 1, to, dt_s, 1.0, periodic::hour_of_week(begin)});
    } catch (...) {
      counts_.pop_back();
      throw;
    }
  }
  see(begin);
}

void SequenceHistory::pool(std::size_t from, std::size_t into) {
  SequenceHistory pooled = *this;
  pooled.counts_[into] += counts_[from];
  pooled.counts_.erase(pooled.counts_.begin() + static_cast<std::ptrdiff_t>(from));
  pooled.transitions_.clear();
  const auto place = [&](std::uint32_t i) {
    const std::size_t joined = i == from ? into : i;
    return static_cast<std::uint32_t>(joined > from ? joined - 1 : joined);
  };
  for (Transition t : transitions_) {
    t.from = place(t.from);
    t.to = place(t.to);
    pooled.add_transition(t);
  }
  *this = std::move(pooled);
}

void SequenceHistory::split(std::size_t i, double dt_s, Stamp begin) {
  counts_.insert(counts_.begin() + static_cast<std::ptrdiff_t>(i) + 1, 1.0);
  for (Transition& t : transitions_) {
    if (t.from >= i) ++t.from;  // what followed the whole follows its end
    if (t.to > i) ++t.to;
  }
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) return;
  const auto first = static_cast<std::uint32_t>(i);
  transitions_.push_back({first, first + 1, dt_s, 1.0, periodic::hour_of_week(begin)});
}

void SequenceHistory::add(const SequenceHistory& other, std::span<const std::uint32_t> places) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] != kGone) counts_[places[i]] += other.counts_[i];
  }
  for (Transition t : other.transitions_) {
    t.from = places[t.from];
    t.to = places[t.to];
    if (t.from != kGone && t.to != kGone) add_transition(t);
  }
  // Of places that become one: seen by the same robots, mostly on the same days.
  if (other.seen_.days > seen_.days) seen_ = other.seen_;
}

bool SequenceHistory::is_alike_but_for_hours(const SequenceHistory& other) const {
  const auto are_equal = [](Transition a, Transition b) {
    a.hour = b.hour;
    return a == b;
  };
  return counts_ == other.counts_ &&
         std::equal(transitions_.begin(), transitions_.end(), other.transitions_.begin(),
                    other.transitions_.end(), are_equal);
}

bool SequenceHistory::is_sound() const {
  const auto is_positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  return std::all_of(counts_.begin(), counts_.end(), is_positive) &&
         std::all_of(transitions_.begin(), transitions_.end(), [&](const Transition& t) {
           return t.from < counts_.size() && t.to < counts_.size() && is_positive(t.dt_s) &&
                  is_positive(t.count) && t.hour >= Transition::kUnknownHour &&
                  t.hour < periodic::kHoursAWeek;
         });
}

SequenceHistory history_of(std::span<const SequenceInfo> sequences) {
  SequenceHistory history;
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    history.append(i == 0 ? 0.0 : (sequences[i].begin - sequences[i - 1].end).seconds(),
                   sequences[i].begin);
  }
  return history;
}

}  // namespace strata::patch
