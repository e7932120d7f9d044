// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/scan_queue.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace strata::runtime {
namespace {

/// Scanners do not turn evenly: the next scan may come after so much of a period.
constexpr double kEarliest = 0.8;
constexpr double kMaxPeriodsWaited = 2.0;
/// A longer step is a hole, no period.
constexpr double kHole = 3.0;

Duration times(Duration period, double factor) {
  return Duration::from_seconds(factor * period.seconds());
}

void learn_period(Scanner& scanner, Duration step) {
  if (step.ns <= 0) return;
  if (!scanner.period || step.ns < scanner.period->ns) {
    scanner.period = step;
  } else if (step.seconds() < kHole * scanner.period->seconds()) {
    scanner.period = Duration{(7 * scanner.period->ns + step.ns) / 8};
  }
}

}  // namespace

bool ScanQueue::is_replaced(const Scanner& scanner) const {
  const std::optional<Stamp>& newest = scanner.watch.newest();
  return scanner.is_silent && newest &&
         std::any_of(scanners_.begin(), scanners_.end(), [&](const Scanner& other) {
           return other.topic == scanner.topic && other.first > *newest;
         });
}

std::size_t ScanQueue::expected() const {
  return static_cast<std::size_t>(
      std::count_if(scanners_.begin(), scanners_.end(),
                    [this](const Scanner& scanner) { return !is_replaced(scanner); }));
}

std::size_t ScanQueue::place_of(std::size_t topic, const std::string& frame) const {
  const auto found = std::find_if(scanners_.begin(), scanners_.end(), [&](const Scanner& scanner) {
    return scanner.topic == topic && scanner.frame == frame;
  });
  return static_cast<std::size_t>(found - scanners_.begin());
}

std::size_t ScanQueue::scanner_of(std::size_t topic, const std::string& frame, Stamp now) {
  const std::size_t place = place_of(topic, frame);
  if (place == scanners_.size()) {
    scanners_.push_back({.topic = topic, .frame = frame, .first = now});
  }
  return place;
}

bool ScanQueue::takes(std::size_t topic, const std::string& frame) const {
  if (!orders_ || place_of(topic, frame) < scanners_.size()) return true;
  const auto is_of_topic = [&](const Scanner& scanner) { return scanner.topic == topic; };
  const auto frames = std::count_if(scanners_.begin(), scanners_.end(), is_of_topic);
  return static_cast<std::size_t>(frames) < kMaxFrames;
}

void ScanQueue::put(WaitingScan waiting) {
  const double late_s = newest_gone_ ? (*newest_gone_ - waiting.stamp()).seconds() : 0.0;
  // What went on before a clock was set back says nothing of what is late now.
  if (late_s > 0.0 && late_s <= log::kMinSetBackS) {
    ++late_;
    return;
  }
  const auto key = [this](const WaitingScan& w) {
    return std::tuple(w.stamp(), scanners_[w.scanner].topic);
  };
  const auto place =
      std::upper_bound(waiting_.begin(), waiting_.end(), waiting,
                       [&](const WaitingScan& a, const WaitingScan& b) { return key(a) < key(b); });
  waiting_.insert(place, std::move(waiting));
}

void ScanQueue::add(std::size_t topic, log::SensedScan sensed,
                    const std::function<void(Stamp)>& set_back) {
  using Verdict = log::SetBackWatch::Verdict;
  const std::size_t index = scanner_of(topic, sensed.frame, sensed.scan.stamp);
  WaitingScan waiting{index, std::move(sensed), {}};
  waiting.end = log::end_of_sweep(waiting.sensed);
  if (!orders_) {
    waiting_.push_back(std::move(waiting));
    return;
  }
  Scanner& scanner = scanners_[index];
  const Stamp stamp = waiting.stamp();
  const std::optional<Stamp> before = scanner.watch.newest();
  const Verdict verdict = scanner.watch.add(stamp);
  std::optional<WaitingScan> suspect = std::exchange(scanner.suspect, std::nullopt);
  scanner.is_silent = false;
  if (verdict == Verdict::kSuspect) {
    if (suspect) ++late_;
    scanner.suspect = std::move(waiting);
    return;
  }
  if (verdict == Verdict::kSetBack && suspect) {
    set_back(suspect->stamp());
    newest_gone_.reset();
    put(std::move(*suspect));
  } else {
    if (suspect) ++late_;
    if (before && verdict == Verdict::kOn) learn_period(scanner, stamp - *before);
  }
  put(std::move(waiting));
}

WaitingScan ScanQueue::pop() {
  WaitingScan oldest = std::move(waiting_.front());
  waiting_.pop_front();
  newest_gone_ = oldest.stamp();
  return oldest;
}

bool ScanQueue::is_next() {
  const WaitingScan& oldest = waiting_.front();
  Stamp newest = oldest.stamp();
  for (const WaitingScan& waiting : waiting_) newest = std::max(newest, waiting.stamp());
  const std::optional<Duration>& own = scanners_[oldest.scanner].period;
  for (std::size_t i = 0; i < scanners_.size(); ++i) {
    Scanner& other = scanners_[i];
    // One that has sent a single scan may be as fast as this one.
    const std::optional<Duration>& period = other.period ? other.period : own;
    if (i == oldest.scanner || other.is_silent || !other.watch.newest() || !period) continue;
    const Stamp expected = *other.watch.newest() + times(*period, kEarliest);
    if (expected > oldest.stamp()) continue;
    const Duration longer = own ? std::max(*own, *period) : *period;
    if (newest - expected <= times(longer, kMaxPeriodsWaited)) return false;
    other.is_silent = true;
  }
  return true;
}

}  // namespace strata::runtime
