// SPDX-License-Identifier: Apache-2.0
#include "core/scan/drop_out_watch.hpp"

#include <algorithm>
#include <iterator>

namespace strata {
namespace {

constexpr std::size_t kMaxStep = kStepsAround.back();
/// Scans that pass by for each one whose beams are counted: a sample is enough.
constexpr std::uint64_t kEvery = 4;
/// Of so many scanners; a message with ever new angles is not one more each.
constexpr std::size_t kMaxScanners = 8;

/// The scan so many from one; nullptr: there is none.
const PosedScan* at(const std::deque<PosedScan>& scans, std::size_t index) {
  return index < scans.size() ? &scans[index] : nullptr;  // below 0 wraps
}

}  // namespace

DropOutWatch::Scanner& DropOutWatch::scanner_for(const PosedScan& scan) {
  const ScannerKey key = scanner_of(scan.scan);
  const auto known = std::find_if(scanners_.begin(), scanners_.end(), [&](const Scanner& one) {
    return scanner_of(one.recent.back().scan) == key;
  });
  if (known != scanners_.end()) return *known;
  if (scanners_.size() == kMaxScanners) scanners_.erase(scanners_.begin());
  scanners_.emplace_back();
  return scanners_.back();
}

void DropOutWatch::take(PosedScan& posed) {
  Scan& scan = posed.scan;
  scan.free_range_m = 0.0F;
  scan.drop_outs.clear();
  if (!config_.is_used || reach_of(scan) <= 0.0) return;
  Scanner& scanner = scanner_for(posed);
  PosedScan kept = posed;
  kept.static_probability = {};
  scanner.recent.push_back(std::move(kept));
  if (scanner.recent.size() > 2 * kMaxStep + 1) scanner.recent.pop_front();
  if (scanner.scans++ % kEvery == 0) judge_earlier(scanner);
  const double free_range_m = scanner.tally.free_range_m(reach_of(scan), config_);
  scan.free_range_m = static_cast<float>(free_range_m);
  if (free_range_m <= 0.0 || !has_no_return(scan)) return;
  const std::size_t own = scanner.recent.size() - 1;
  before_.lay(posed, [&](std::size_t step) { return at(scanner.recent, own - step); });
  if (before_.get().empty()) {
    scan.free_range_m = 0.0F;
    return;
  }
  for_each_silent(scan, before_.get(), {}, reach_of(scan),
                  [&](std::uint32_t beam) { scan.drop_outs.push_back(beam); });
}

/// The scan that has kMaxStep later ones.
void DropOutWatch::judge_earlier(Scanner& scanner) {
  if (scanner.recent.size() <= kMaxStep) return;
  const std::size_t own = scanner.recent.size() - 1 - kMaxStep;
  const PosedScan& posed = scanner.recent[own];
  if (!has_no_return(posed.scan)) return;
  before_.lay(posed, [&](std::size_t step) { return at(scanner.recent, own - step); });
  after_.lay(posed, [&](std::size_t step) { return at(scanner.recent, own + step); });
  (void)judge_beams(posed.scan, before_.get(), after_.get(), reach_of(posed.scan), scanner.tally);
}

DropOuts DropOutWatch::found() const {
  DropOuts sum;
  for (const Scanner& scanner : scanners_) {
    scanner.tally.report(sum);
    sum.free_range_m =
        std::max(sum.free_range_m,
                 scanner.tally.free_range_m(reach_of(scanner.recent.back().scan), config_));
  }
  return sum;
}

}  // namespace strata
