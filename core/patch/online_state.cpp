// SPDX-License-Identifier: Apache-2.0
/// What an online learner holds, as bytes and back.
#include <cstdint>
#include <type_traits>
#include <utility>

#include "core/grid/grid_state.hpp"
#include "core/patch/online_learner.hpp"
#include "core/scan/scan_state.hpp"

namespace strata::patch {
namespace {

/// Changes with the fields below: bytes of another version are refused.
constexpr std::uint64_t kVersion = 0x53'50'4c'31'0000'0002;

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

template <class Map, class Archive>
void submap_state(Map& submap, Archive& archive) {
  archive(submap.id);
  archive(submap.rect);
  archive(submap.contradictory);
  each(submap.configurations, archive, [&](auto& configuration) {
    archive(configuration.counts);
    archive(configuration.reflection);
    archive(configuration.prior);
  });
  each(submap.sequences, archive, [&](auto& info) { sequence_info(info, archive); });
}

template <class One, class Archive>
void track_state(One& track, Archive& archive) {
  archive(track.region.rect);
  archive(track.region.cells);
  archive(track.region.oversized);
  archive(track.builder);
  each(track.kept, archive, [&](auto& kept) {
    archive(kept.first_scan);
    archive(kept.last_scan);
    sequence_info(kept.info, archive);
    archive(kept.counts);
  });
  submap_state(track.submap, archive);
  archive(track.is_dirty);
}

}  // namespace

template <class Self, class Archive>
void OnlinePatchLearner::state(Self& self, Archive& archive) {
  archive(self.base_);
  archive(self.visits_);
  archive(self.contradictory_);
  archive(self.scans_);
  archive(self.reach_m_);
  archive(self.first_scan_);
  archive(self.scan_bytes_);
  archive(self.most_sequences_);
  archive(self.is_checked_);
  archive(self.last_check_);
  archive(self.last_run_);
  archive(self.status_);
  if constexpr (!std::is_const_v<Self>) archive.check_bool(self.status_.is_over_budget);
}

std::vector<std::uint8_t> OnlinePatchLearner::save_state() const {
  StateWriter writer;
  writer(kVersion);
  state(*this, writer);
  writer(static_cast<std::uint64_t>(tracks_.size()));
  for (const Track& track : tracks_) track_state(track, writer);
  return writer.take();
}

void OnlinePatchLearner::restore_state(std::span<const std::uint8_t> bytes,
                                       const std::string& place) {
  StateReader reader(bytes, place);
  std::uint64_t version = 0;
  reader(version);
  if (version != kVersion) reader.refuse("is of another version");
  const double resolution_m = base_.resolution_m();
  state(*this, reader);
  if (base_.resolution_m() != resolution_m) reader.refuse("is of another resolution");
  if (reach_m_.size() != scans_.size()) reader.fail("has scans without their reach");
  tracks_.clear();
  for (std::size_t left = reader.length(1); left > 0; --left) {
    tracks_.push_back({{}, SequenceBuilder(config_.sequences), {}, {}, false});
    track_state(tracks_.back(), reader);
  }
  reader.expect_end();
}

}  // namespace strata::patch
