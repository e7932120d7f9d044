// SPDX-License-Identifier: Apache-2.0
#include "core/scan/drop_outs.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/scan/scans_around.hpp"

namespace strata {
namespace {

constexpr std::size_t kChunk = 64;

/// The scans of one scanner, in order.
class Judge {
 public:
  Judge(std::span<PosedScan> scans, std::vector<std::size_t> own)
      : scans_(scans),
        own_(std::move(own)),
        is_judged_(own_.size(), 0),
        reach_m_(reach_of(scans_[own_.front()].scan)) {}

  [[nodiscard]] double reach_m() const { return reach_m_; }

  /// Judges every scan's beams without return. Nothing where the reach is not told.
  DropOutTally judge(WorkerPool& pool) {
    DropOutTally sum;
    if (reach_m_ <= 0.0) return sum;
    std::vector<DropOutTally> partial((own_.size() + kChunk - 1) / kChunk);
    pool.for_chunks(own_.size(), kChunk,
                    [&](std::size_t begin, std::size_t end, std::size_t chunk) {
                      SurfacesAround before;
                      SurfacesAround after;
                      for (std::size_t i = begin; i < end; ++i) {
                        judge_scan(i, before, after, partial[chunk]);
                      }
                    });
    for (const DropOutTally& tally : partial) sum.add(tally);
    return sum;
  }

  void set(double free_range_m) {
    for (std::size_t i = 0; i < own_.size(); ++i) {
      Scan& scan = scans_[own_[i]].scan;
      scan.free_range_m = is_judged_[i] != 0 ? static_cast<float>(free_range_m) : 0.0F;
      if (scan.free_range_m <= 0.0F) scan.drop_outs = {};
    }
  }

 private:
  void judge_scan(std::size_t at, SurfacesAround& before, SurfacesAround& after,
                  DropOutTally& tally) {
    PosedScan& posed = scans_[own_[at]];
    if (!has_no_return(posed.scan)) return;
    before.lay(posed, [&](std::size_t step) { return at < step ? nullptr : &scan(at - step); });
    after.lay(posed, [&](std::size_t step) {
      return at + step < own_.size() ? &scan(at + step) : nullptr;
    });
    if (!judge_beams(posed.scan, before.get(), after.get(), reach_m_, tally)) return;
    is_judged_[at] = 1;
    for_each_silent(posed.scan, before.get(), after.get(), reach_m_,
                    [&](std::uint32_t beam) { posed.scan.drop_outs.push_back(beam); });
  }
  [[nodiscard]] const PosedScan& scan(std::size_t at) const { return scans_[own_[at]]; }

  std::span<PosedScan> scans_;
  std::vector<std::size_t> own_;
  std::vector<std::uint8_t> is_judged_;  ///< of each; those without such beams are not
  double reach_m_ = 0.0;
};

}  // namespace

DropOuts find_drop_outs(std::span<PosedScan> scans, const NoReturnConfig& config,
                        WorkerPool& pool) {
  DropOuts found;
  std::vector<std::pair<ScannerKey, std::vector<std::size_t>>> scanners;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    scans[i].scan.free_range_m = 0.0F;
    scans[i].scan.drop_outs.clear();
    const ScannerKey scanner = scanner_of(scans[i].scan);
    auto known = std::find_if(scanners.begin(), scanners.end(),
                              [&](const auto& one) { return one.first == scanner; });
    if (known == scanners.end()) known = scanners.insert(known, {scanner, {}});
    known->second.push_back(i);
  }
  if (!config.is_used) return found;
  for (auto& [scanner, own] : scanners) {
    Judge judge(scans, std::move(own));
    const DropOutTally tally = judge.judge(pool);
    const double free_range_m = tally.free_range_m(judge.reach_m(), config);
    judge.set(free_range_m);
    tally.report(found);
    found.free_range_m = std::max(found.free_range_m, free_range_m);
  }
  return found;
}

}  // namespace strata
