// SPDX-License-Identifier: Apache-2.0
// What an online learner forgets, and in which order, to stay within its memory.
#include <algorithm>
#include <iterator>
#include <utility>

#include "core/patch/looks.hpp"
#include "core/patch/online_learner.hpp"

namespace strata::patch {
namespace {

constexpr int kMinSequences = 8;
constexpr int kMinVisits = 4;
/// How much more than needed is forgotten at once, so that it does not happen at every scan.
constexpr double kAtOnce = 0.1;

}  // namespace

/// The two oldest sequences of the configuration with the most become one, until few enough are
/// left. Requires a sub-map just learned: its sequences are those kept.
void OnlinePatchLearner::pool_surplus(Track& track) {
  std::vector<SequenceInfo>& infos = track.submap.sequences;
  while (track.kept.size() > static_cast<std::size_t>(max_sequences_) &&
         infos.size() == track.kept.size()) {
    std::vector<std::vector<std::size_t>> of(track.submap.configurations.size());
    for (std::size_t i = 0; i < infos.size(); ++i) of[likeliest(infos[i].membership)].push_back(i);
    const auto most = std::max_element(
        of.begin(), of.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (most->size() < 2) return;
    const std::size_t a = (*most)[0];
    const std::size_t b = (*most)[1];
    track.history.pool(a, b);  // all or nothing; what follows asks for no memory
    Kept& into = track.kept[b];
    for (std::size_t c = 0; c < into.counts.size(); ++c) {
      into.counts.values()[c].hits += track.kept[a].counts.values()[c].hits;
      into.counts.values()[c].misses += track.kept[a].counts.values()[c].misses;
    }
    into.info.scans += track.kept[a].info.scans;
    infos[b].scans = into.info.scans;
    // Once the scans of the older are forgotten, a new sub-map here takes over what they counted.
    into.first_scan = std::min(into.first_scan, track.kept[a].first_scan);
    track.kept.erase(track.kept.begin() + static_cast<std::ptrdiff_t>(a));
    infos.erase(infos.begin() + static_cast<std::ptrdiff_t>(a));
    ++status_.pooled_sequences;
  }
}

/// Forgets the configuration that was seen longest ago, of the sub-maps that have more than two.
void OnlinePatchLearner::forget_configuration() {
  Track* from = nullptr;
  std::size_t oldest = 0;
  std::uint32_t oldest_scan = 0;
  for (Track& track : tracks_) {
    const std::vector<SequenceInfo>& infos = track.submap.sequences;
    const std::size_t count = track.submap.configurations.size();
    if (count <= 2 || infos.size() != track.kept.size()) continue;
    std::vector<std::uint32_t> newest(count, 0);
    for (std::size_t i = 0; i < infos.size(); ++i) {
      std::uint32_t& scan = newest[likeliest(infos[i].membership)];
      scan = std::max(scan, track.kept[i].last_scan);
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (from != nullptr && newest[k] >= oldest_scan) continue;
      from = &track;
      oldest = k;
      oldest_scan = newest[k];
    }
  }
  if (from == nullptr) return;
  std::vector<std::uint32_t> places(from->kept.size(), SequenceHistory::kGone);
  std::uint32_t count_left = 0;
  for (std::size_t i = 0; i < from->kept.size(); ++i) {
    if (likeliest(from->submap.sequences[i].membership) != oldest) places[i] = count_left++;
  }
  SequenceHistory history(count_left);
  history.add(from->history, places);
  std::vector<Kept> left;
  left.reserve(count_left);  // what follows asks for no memory
  for (std::size_t i = 0; i < from->kept.size(); ++i) {
    if (places[i] != SequenceHistory::kGone) left.push_back(std::move(from->kept[i]));
  }
  from->history = std::move(history);
  from->kept = std::move(left);
  from->is_dirty = true;
  ++status_.forgotten_configurations;
  (void)learn_dirty();
}

void OnlinePatchLearner::forget_scans(std::size_t bytes_to_free) {
  std::uint32_t needed_from = first_scan_ + static_cast<std::uint32_t>(scans_.size());
  if (!scans_.empty()) --needed_from;  // the newest says when it is
  for (const Track& track : tracks_) {
    const std::vector<std::uint32_t>& open = track.builder.open().scans;
    if (!open.empty()) needed_from = std::min(needed_from, open.front());
  }
  std::size_t count = 0;
  std::size_t freed = 0;
  while (freed < bytes_to_free && first_scan_ + count < needed_from) {
    freed += scan_bytes_of(scans_[count++]);
  }
  scan_bytes_ -= freed;
  const auto gone = static_cast<std::ptrdiff_t>(count);
  scans_.erase(scans_.begin(), scans_.begin() + gone);
  reach_m_.erase(reach_m_.begin(), reach_m_.begin() + gone);
  first_scan_ += static_cast<std::uint32_t>(count);
}

std::size_t OnlinePatchLearner::scan_bytes_of(const PosedScan& scan) {
  return sizeof(PosedScan) + sizeof(float) + scan.scan.ranges_m.size() * sizeof(float) +
         scan.scan.drop_outs.size() * sizeof(std::uint32_t);
}

std::size_t OnlinePatchLearner::count_bytes() {
  std::size_t bytes = visits_.bytes() + scan_bytes_ + contradictory_.size();
  // Sizes, not capacities: what is forgotten must not depend on how memory was asked for. The list
  // of scans may have as much room again.
  bytes += scans_.size() * sizeof(PosedScan);
  status_.sequences = 0;
  for (const Track& track : tracks_) {
    const std::size_t area = track.region.rect.area();
    bytes += track.region.cells.size() * sizeof(Cell);
    bytes += track.kept.size() * (sizeof(Kept) + area * sizeof(Evidence)) + track.history.bytes();
    bytes +=
        track.submap.configurations.size() * area * (sizeof(CellCounts) + sizeof(float)) + area;
    status_.sequences += track.kept.size();
  }
  status_.bytes = bytes;
  status_.scans = scans_.size();
  return bytes;
}

void OnlinePatchLearner::hold_budget() {
  const auto budget = static_cast<std::size_t>(online_.memory_mb * 1e6);
  const auto too_much = [&] {
    const std::size_t bytes = count_bytes();
    return bytes > budget ? bytes - budget : 0;
  };
  status_.is_over_budget = false;
  if (too_much() == 0) return;
  forget_scans(too_much() + static_cast<std::size_t>(kAtOnce * static_cast<double>(budget)));
  while (too_much() > 0 && max_sequences_ > kMinSequences) {
    max_sequences_ = std::max(kMinSequences, 3 * max_sequences_ / 4);
    for (Track& track : tracks_) pool_surplus(track);
  }
  while (too_much() > 0 && visits_.most() > kMinVisits) visits_.trim(3 * visits_.most() / 4);
  for (std::size_t before = status_.forgotten_configurations; too_much() > 0; ++before) {
    forget_configuration();
    if (status_.forgotten_configurations == before) break;
  }
  status_.is_over_budget = too_much() > 0;
}

}  // namespace strata::patch
