// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scanner_turns.hpp"

#include <algorithm>

namespace strata {
namespace {

/// A scanner that sent none of so many scans is off, or was never one: mountings may be measured
/// anew, too.
constexpr std::uint64_t kAliveScans = 40;
constexpr std::size_t kMaxScanners = 16;

}  // namespace

void ScannerTurns::see(const Scan& scan, int run) {
  if (run != run_) scanners_.clear();
  run_ = run;
  ++seen_;
  const auto found = std::find_if(scanners_.begin(), scanners_.end(), [&](const Scanner& known) {
    return known.robot_from_laser == scan.robot_from_laser;
  });
  newest_ = static_cast<std::uint64_t>(found - scanners_.begin());
  if (found == scanners_.end()) {
    if (scanners_.size() == kMaxScanners) {
      scanners_.clear();
      newest_ = 0;
    }
    scanners_.push_back({scan.robot_from_laser});
  }
  scanners_[newest_].seen = seen_;
}

bool ScannerTurns::is_alive(const Scanner& scanner) const {
  return scanner.seen + kAliveScans > seen_;
}

bool ScannerTurns::has_turn() {
  if (scanners_.size() <= 1 || newest_ >= scanners_.size()) return true;
  Scanner& own = scanners_[newest_];
  const bool waits = std::any_of(scanners_.begin(), scanners_.end(), [&](const Scanner& other) {
    return is_alive(other) && other.used < own.used;
  });
  if (!waits || own.passed != 0) return true;
  own.passed = 1;
  return false;
}

void ScannerTurns::use() {
  if (newest_ >= scanners_.size()) return;
  scanners_[newest_].used = seen_;
  for (Scanner& scanner : scanners_) scanner.passed = 0;
}

std::size_t ScannerTurns::alive() const {
  const auto count = std::count_if(scanners_.begin(), scanners_.end(),
                                   [&](const Scanner& scanner) { return is_alive(scanner); });
  return std::max<std::size_t>(1, static_cast<std::size_t>(count));
}

}  // namespace strata
