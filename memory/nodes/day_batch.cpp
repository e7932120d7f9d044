// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/day_batch.hpp"

#include <algorithm>

namespace strata::memory {
namespace {

constexpr std::int64_t kDay_ns = 86'400'000'000'000;
/// Clocks that were set back one after the other, each to before all ends that are known.
constexpr std::size_t kMaxEarlier = 8;

std::int64_t day_of(Stamp stamp) {
  // Towards minus infinity, for stamps before the epoch.
  return stamp.ns >= 0 ? stamp.ns / kDay_ns : -((-stamp.ns + kDay_ns - 1) / kDay_ns);
}

}  // namespace

bool DayBatch::is_over(int run, Stamp stamp) const {
  if (scans_ == 0) return false;
  // A day that began by a clock far ahead ends when that is put right; stamps out of order do not.
  const bool is_set_back = day_of(stamp) + 1 < day_of(span_.begin);
  return span_.run != run || day_of(stamp) > day_of(span_.end) || is_set_back;
}

void DayBatch::add(const VirtualScan& scan, int run, Stamp stamp, RandomStream& random) {
  if (scans_ == 0) span_ = {run, stamp, stamp};
  span_.end = std::max(span_.end, stamp);
  ++scans_;
  const double share = seen_.capacity() / static_cast<double>(scans_);
  if (random.bernoulli(std::min(1.0, share))) seen_.insert(scan, random);
}

double DayBatch::days() const {
  if (closed_ == 0) return 1.0;
  // A run whose clock begins somewhat late, as after a boot without a clock of its own, goes on.
  const bool goes_on = span_.run != before_.run && span_.begin > before_.begin;
  if (span_.begin <= before_.end && !(goes_on && span_.end > before_.end)) return 1.0;
  Stamp last = before_.end;
  for (const Stamp end : earlier_) {
    if (end <= span_.end) last = std::max(last, end);
  }
  return (span_.end - last).seconds() / 86400.0;
}

void DayBatch::close() {
  if (closed_ > 0 && before_.end > span_.end) {
    if (earlier_.size() == kMaxEarlier) earlier_.pop_back();
    earlier_.push_back(before_.end);
  }
  while (!earlier_.empty() && earlier_.back() <= span_.end) earlier_.pop_back();
  before_ = span_;
  ++closed_;
  scans_ = 0;
  seen_.clear();
}

std::size_t DayBatch::bytes() const {
  return 88 + earlier_.size() * sizeof(Stamp) +
         4 * static_cast<std::size_t>(seen_.bins().angle_bins) +
         seen_.sample_count() * sizeof(float) + seen_.pair_count() * sizeof(RangePair);
}

}  // namespace strata::memory
