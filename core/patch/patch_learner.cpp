// SPDX-License-Identifier: Apache-2.0
#include "core/patch/patch_learner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/patch/change_in_view.hpp"
#include "core/patch/configurations.hpp"
#include "core/patch/sequence_history.hpp"

namespace strata::patch {
namespace {

constexpr std::size_t kRegionsPerReport = 8;

}  // namespace

PatchLearner::PatchLearner(const PatchLearnerConfig& config, int threads)
    : config_(config), pool_(threads) {
  require_valid(config_, "patch_learner");
}

void PatchLearner::add(PosedScan scan) {
  if (!is_finite(scan.map_from_robot)) return;
  scan.static_probability = {};
  scans_.push_back(std::move(scan));
}

Submap PatchLearner::learn_submap(const Region& region, std::span<const Sequence> sequences,
                                  const ReflectionGrid& filtered) const {
  std::vector<SequenceInfo> infos;
  for (const Sequence& sequence : sequences) {
    const PosedScan& first = scans_[sequence.scans.front()];
    const PosedScan& last = scans_[sequence.scans.back()];
    infos.push_back({first.run, first.scan.stamp, last.scan.stamp, sequence.scans.size(), {}});
  }
  // Counts are made twice instead of kept, so that memory does not grow with the sequences.
  const auto count = [&](std::size_t i) {
    return count_sequence(scans_, sequences[i], region.rect, filtered.resolution_m(),
                          config_.counting);
  };
  return learn_configurations(region, infos, history_of(infos), count, filtered, config_);
}

PatchMap PatchLearner::finish(const ReflectionGrid& filtered, Progress* progress) {
  const double resolution = filtered.resolution_m();
  // Again after SLAM: at the last poses, and scans that come over topics do not tell.
  (void)find_drop_outs(scans_, config_.no_return, pool_);
  PatchMap map;
  map.base = filtered;
  map.entry_margin_m = config_.sequences.entry_margin_m;
  std::vector<Region> regions;
  std::vector<std::vector<std::uint32_t>> changes;  // of each region, in view
  {
    VisitTable visits = find_visits(scans_, resolution, config_.visits, config_.counting, progress);
    visits.filter(config_.contradiction.prior);
    report_progress(progress, "test contradictions", 0, 1);
    regions = grow_regions(find_contradictions(visits, config_.contradiction), config_.regions);
    regions = join_regions(std::move(regions), filtered, config_.regions);
    for (const Region& region : regions) {
      changes.push_back(changes_in_view(visits, region.cells, scans_, 0, config_.visits.gap_s));
    }
  }
  std::vector<CellRect> rects;
  for (const Region& region : regions) rects.push_back(region.rect);
  auto sequences =
      find_sequences(scans_, rects, resolution, config_.sequences, config_.counting, progress);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    std::vector<Sequence> whole = std::exchange(sequences[r], {});
    for (const Sequence& sequence : whole) {
      for (Sequence& part : cut_at(sequence, changes[r], config_.sequences.min_scans)) {
        sequences[r].push_back(std::move(part));
      }
    }
  }
  std::vector<Submap> submaps(regions.size());
  for (std::size_t begin = 0; begin < regions.size(); begin += kRegionsPerReport) {
    report_progress(progress, "learn configurations", begin, regions.size());
    pool_.for_chunks(std::min(kRegionsPerReport, regions.size() - begin), 1,
                     [&](std::size_t i, std::size_t, std::size_t) {
                       submaps[begin + i] =
                           learn_submap(regions[begin + i], sequences[begin + i], filtered);
                     });
  }
  keep_changing(std::move(submaps), config_, map);
  report_progress(progress, "learn configurations", regions.size(), regions.size());
  return map;
}

}  // namespace strata::patch
