// SPDX-License-Identifier: Apache-2.0
/// What an online learner does when it notices, a while later, that a sub-map changed in view.
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "core/patch/change_in_view.hpp"
#include "core/patch/online_learner.hpp"

namespace strata::patch {
namespace {

/// Those within (first, last]: they cut a sequence of these scans.
std::span<const std::uint32_t> within(std::span<const std::uint32_t> changes, std::uint32_t first,
                                      std::uint32_t last) {
  const auto begin = std::upper_bound(changes.begin(), changes.end(), first);
  return {begin, std::upper_bound(begin, changes.end(), last)};
}

}  // namespace

std::vector<std::uint32_t> OnlinePatchLearner::changes_of(const Track& track) const {
  return changes_in_view(visits_.table(track.region.rect), track.region.cells, scans_, first_scan_,
                         config_.visits.gap_s);
}

/// The scans of a sequence whose first and last scan are known, and still there.
Sequence OnlinePatchLearner::sequence_within(const Track& track, std::uint32_t first,
                                             std::uint32_t last) const {
  SequenceMembership membership(config_.sequences, config_.counting, base_.resolution_m());
  Sequence sequence;
  for (std::uint32_t scan = first; scan <= last; ++scan) {
    membership.set_scan(scans_[scan - first_scan_]);
    if (membership.belongs_to(track.region.rect)) sequence.scans.push_back(scan);
  }
  return sequence;
}

void OnlinePatchLearner::follow_changes(Track& track) const {
  std::vector<std::uint32_t> changes = changes_of(track);
  if (track.changes == changes) return;
  Track next = track;  // takes its place when it is whole: memory may run out meanwhile
  const std::vector<std::uint32_t> before = std::exchange(next.changes, std::move(changes));
  cut_again(next, before);
  track = std::move(next);
}

void OnlinePatchLearner::cut_again(Track& track, std::span<const std::uint32_t> before) const {
  const std::vector<SequenceInfo> infos = infos_of(track);
  const bool is_plain = track.history == history_of(infos);
  std::vector<Kept> kept;
  bool has_cut = false;
  for (std::size_t begin = 0; begin < track.kept.size();) {
    const auto [first, last] =
        std::pair(track.kept[begin].whole_first, track.kept[begin].whole_last);
    std::size_t end = begin + 1;
    while (end < track.kept.size() && track.kept[end].whole_first == first) ++end;
    const auto then = within(before, first, last);
    const auto now = within(track.changes, first, last);
    const bool is_there = first >= first_scan_ && track.history.counts()[begin] == 1.0;
    // With pooled sequences a history has room for more entries, not for fewer.
    const bool may_cut = is_there && (is_plain || (end == begin + 1 && then.empty()));
    if (!may_cut || std::equal(then.begin(), then.end(), now.begin(), now.end())) {
      std::move(track.kept.begin() + static_cast<std::ptrdiff_t>(begin),
                track.kept.begin() + static_cast<std::ptrdiff_t>(end), std::back_inserter(kept));
      begin = end;
      continue;
    }
    has_cut = true;
    const Sequence whole = sequence_within(track, first, last);
    const std::size_t place = kept.size();
    for (const Sequence& part : cut_at(whole, now, config_.sequences.min_scans)) {
      kept.push_back(count_kept(track, part, whole));
      if (is_plain || kept.size() == place + 1) continue;
      const Kept& earlier = kept[kept.size() - 2];
      const Stamp begin_of_part = kept.back().info.begin;
      track.history.split(kept.size() - 2, (begin_of_part - earlier.info.end).seconds(),
                          begin_of_part);
    }
    begin = end;
  }
  track.kept = std::move(kept);
  if (!has_cut) return;
  track.is_dirty = true;
  if (is_plain) track.history = history_of(infos_of(track));
}

OnlinePatchLearner::Kept OnlinePatchLearner::count_kept(const Track& track, const Sequence& part,
                                                        const Sequence& whole) const {
  Sequence here = part;
  for (std::uint32_t& scan : here.scans) scan -= first_scan_;
  const Grid<CellCounts> counts =
      count_sequence(scans_, here, track.region.rect, base_.resolution_m(), config_.counting);
  const PosedScan& first = scans_[here.scans.front()];
  const PosedScan& last = scans_[here.scans.back()];
  Kept kept;
  kept.first_scan = part.scans.front();
  kept.last_scan = part.scans.back();
  kept.whole_first = whole.scans.front();
  kept.whole_last = whole.scans.back();
  kept.info = {first.run, first.scan.stamp, last.scan.stamp, here.scans.size(), {}};
  kept.counts = Grid<Evidence>(base_.resolution_m(), track.region.rect);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const CellCounts& cell = counts.values()[i];
    kept.counts.values()[i] = {static_cast<float>(cell.hits), static_cast<float>(cell.misses)};
  }
  return kept;
}

std::vector<SequenceInfo> OnlinePatchLearner::infos_of(const Track& track) {
  std::vector<SequenceInfo> infos;
  for (const Kept& kept : track.kept) infos.push_back(kept.info);
  return infos;
}

}  // namespace strata::patch
