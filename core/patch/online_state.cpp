// SPDX-License-Identifier: Apache-2.0
/// What an online learner holds, as bytes and back.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <type_traits>
#include <utility>

#include "core/grid/grid_state.hpp"
#include "core/patch/online_learner.hpp"
#include "core/scan/scan_state.hpp"

namespace strata::patch {
namespace {

/// Changes with the fields below: bytes of another version are refused, but for these before: none
/// of them told what beams without return say, the first four what returns, the first three had no
/// times of the week, the first two no changes in view, and the first no history.
constexpr std::uint64_t kVersion = 0x53'50'4c'31'0000'0008;
constexpr std::uint64_t kWithoutDropOuts = 0x53'50'4c'31'0000'0007;
constexpr std::uint64_t kWithoutRecurrence = 0x53'50'4c'31'0000'0006;
constexpr std::uint64_t kWithoutTimes = 0x53'50'4c'31'0000'0005;
constexpr std::uint64_t kWithoutChanges = 0x53'50'4c'31'0000'0004;
constexpr std::uint64_t kWithoutHistory = 0x53'50'4c'31'0000'0003;

/// What bytes of a version hold.
struct Has {
  bool history = true;
  bool changes = true;
  bool times = true;
  bool recurrence = true;
};

// What follows is read and written in one order.
template <class Info, class Archive>
void sequence_info(Info& info, Archive& archive) {
  archive(info.run);
  archive(info.begin);
  archive(info.end);
  archive(info.scans);
  archive(info.membership);
}

/// Calls item(element) for each, after their number.
template <class Items, class Archive, class Item>
void each(Items& items, Archive& archive, const Item& item) {
  if constexpr (std::is_const_v<Items>) {
    archive(static_cast<std::uint64_t>(items.size()));
  } else {
    items.resize(archive.length(1));
  }
  for (auto& element : items) item(element);
}

template <class Shares, class Archive>
void periodic_shares(Shares& usual, Archive& archive) {
  archive(usual.logit);
  each(usual.harmonics, archive, [&](auto& wave) {
    archive(wave.cycles_a_week);
    archive(wave.cosine);
    archive(wave.sine);
  });
  if constexpr (Archive::kReads) {
    if (!periodic::is_sound(usual)) archive.fail("has damaged times of the week");
  }
}

template <class Map, class Archive>
void submap_state(Map& submap, const Has& has, Archive& archive) {
  archive(submap.id);
  archive(submap.rect);
  archive(submap.contradictory);
  each(submap.configurations, archive, [&](auto& configuration) {
    archive(configuration.counts);
    archive(configuration.reflection);
    archive(configuration.prior);
  });
  each(submap.sequences, archive, [&](auto& info) { sequence_info(info, archive); });
  if (has.history) archive(submap.change_rate_per_s);
  if (has.times) periodic_shares(submap.usual, archive);
  if (has.recurrence) {
    archive(submap.recurrence.appearances);
    archive(submap.recurrence.kinds);
    if constexpr (Archive::kReads) {
      const Recurrence& seen = submap.recurrence;
      const bool is_sound =
          std::isfinite(seen.appearances) && seen.kinds >= 0.0 && seen.kinds <= seen.appearances;
      if (!is_sound) archive.fail("has a damaged count of what returned");
    }
  }
}

template <class One, class Archive>
void track_state(One& track, const Has& has, Archive& archive) {
  archive(track.region.rect);
  archive(track.region.cells);
  archive(track.region.oversized);
  archive(track.builder);
  each(track.kept, archive, [&](auto& kept) {
    archive(kept.first_scan);
    archive(kept.last_scan);
    if (has.changes) {
      archive(kept.whole_first);
      archive(kept.whole_last);
    } else if constexpr (Archive::kReads) {
      kept.whole_first = kept.first_scan;
      kept.whole_last = kept.last_scan;
    }
    sequence_info(kept.info, archive);
    archive(kept.counts);
  });
  if (has.history) SequenceHistory::state(track.history, archive, has.times);
  submap_state(track.submap, has, archive);
  archive(track.is_dirty);
  if (has.changes) archive(track.changes);
}

}  // namespace

template <class Self, class Archive>
void OnlinePatchLearner::state(Self& self, Archive& archive, bool has_changes) {
  VisitStore::state(self.visits_, archive, has_changes);
  archive(self.contradictory_);
  archive(self.scans_);
  archive(self.reach_m_);
  archive(self.first_scan_);
  archive(self.scan_bytes_);
  archive(self.max_sequences_);
  archive(self.is_checked_);
  archive(self.last_check_);
  archive(self.last_run_);
  archive(self.status_.bytes);
  archive(self.status_.scans);
  archive(self.status_.scans_seen);
  archive(self.status_.sequences);
  archive(self.status_.pooled_sequences);
  archive(self.status_.forgotten_configurations);
  archive(self.status_.is_over_budget);
}

std::vector<std::uint8_t> OnlinePatchLearner::save_state() const {
  StateWriter writer;
  writer(kVersion);
  writer(base_);
  state(*this, writer, true);
  writer(static_cast<std::uint64_t>(tracks_.size()));
  for (const Track& track : tracks_) track_state(track, Has{}, writer);
  writer(drop_outs_);
  for (const PosedScan& scan : scans_) no_return_state_of(scan.scan, writer);
  return writer.take();
}

void OnlinePatchLearner::restore_state(std::span<const std::uint8_t> bytes,
                                       const std::string& place) {
  StateReader reader(bytes, place);
  std::uint64_t version = 0;
  reader(version);
  if (version < kWithoutHistory || version > kVersion) reader.refuse("is of another version");
  const Has has{version > kWithoutHistory, version > kWithoutChanges, version > kWithoutTimes,
                version > kWithoutRecurrence};
  const double resolution_m = base_.resolution_m();
  reader(base_);
  if (base_.resolution_m() != resolution_m) reader.refuse("is of another resolution");
  state(*this, reader, has.changes);
  tracks_.clear();
  for (std::size_t left = reader.length(1); left > 0; --left) {
    tracks_.push_back({{}, SequenceBuilder(config_.sequences), {}, {}, {}, false});
    Track& track = tracks_.back();
    track_state(track, has, reader);
    if (has.times) continue;
    SequenceHistory plain = history_of(infos_of(track));
    if (!has.history || plain.is_alike_but_for_hours(track.history)) {
      track.history = std::move(plain);
    }
  }
  if (version > kWithoutDropOuts) {
    reader(drop_outs_);
    for (PosedScan& scan : scans_) no_return_state_of(scan.scan, reader);
  }
  reader.expect_end();
  const bool is_whole = has_sound_scans() && contradictory_.resolution_m() == resolution_m &&
                        std::all_of(tracks_.begin(), tracks_.end(),
                                    [this](const Track& track) { return is_sound(track); });
  if (!is_whole) reader.fail("does not fit together");
}

bool OnlinePatchLearner::has_sound_scans() const {
  return reach_m_.size() == scans_.size() && first_scan_ + scans_.size() == status_.scans_seen &&
         max_sequences_ > 0;
}

bool OnlinePatchLearner::is_sound(const Track& track) const {
  const double resolution_m = base_.resolution_m();
  const CellRect& rect = track.region.rect;
  const auto covers = [&](const auto& grid) {
    return grid.rect() == rect && grid.resolution_m() == resolution_m;
  };
  const std::vector<Cell>& cells = track.region.cells;
  if (!std::all_of(cells.begin(), cells.end(), [&](const Cell& c) { return rect.contains(c); })) {
    return false;
  }
  // Ascending, of scans that are there.
  const std::vector<std::uint32_t>& open = track.builder.open().scans;
  const bool is_in_order =
      std::adjacent_find(open.begin(), open.end(), std::greater_equal<>()) == open.end();
  if (!open.empty() &&
      (!is_in_order || open.front() < first_scan_ || open.back() >= status_.scans_seen)) {
    return false;
  }
  if (track.history.size() != track.kept.size()) return false;
  for (const Kept& kept : track.kept) {
    if (!covers(kept.counts) || kept.last_scan >= status_.scans_seen) return false;
    if (kept.whole_first > kept.whole_last || kept.whole_last >= status_.scans_seen) return false;
  }
  const Submap& submap = track.submap;
  for (const Configuration& configuration : submap.configurations) {
    if (!covers(configuration.counts) || !covers(configuration.reflection)) return false;
  }
  const bool is_learned = !submap.configurations.empty();
  if (is_learned && (submap.rect != rect || !covers(submap.contradictory))) return false;
  return std::all_of(submap.sequences.begin(), submap.sequences.end(), [&](const auto& sequence) {
    return is_learned && sequence.membership.size() == submap.configurations.size();
  });
}

}  // namespace strata::patch
