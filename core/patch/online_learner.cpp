// SPDX-License-Identifier: Apache-2.0
#include "core/patch/online_learner.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/patch/change_in_view.hpp"
#include "core/patch/configurations.hpp"
#include "core/patch/contradiction.hpp"

namespace strata::patch {
namespace {

/// A check looks at no more than this at a time, and this far beyond for tolerance and context.
constexpr double kWindowM = 20.0;
constexpr double kContextM = 1.0;

}  // namespace

OnlinePatchLearner::OnlinePatchLearner(const PatchLearnerConfig& config, const OnlineConfig& online,
                                       ReflectionGrid base, int threads)
    : config_(config),
      online_(online),
      pool_(threads),
      base_(std::move(base)),
      drop_outs_(config.no_return),
      visits_(base_.resolution_m(), config.visits, config.counting, online.max_visits),
      contradictory_(base_.resolution_m(), CellRect{}, 0),
      max_sequences_(online.max_sequences) {
  require_valid(config_, "patch_learner");
  require_valid(online_, "patch_learner.online");
}

bool OnlinePatchLearner::add(PosedScan scan) {
  if (!is_finite(scan.map_from_robot)) return false;
  scan.static_probability = {};
  scan.scan.ranges_m.shrink_to_fit();
  drop_outs_.take(scan);
  const auto index = static_cast<std::uint32_t>(status_.scans_seen);
  const bool is_new_run = scans_.empty() || scan.run != last_run_;
  const Stamp now = scan.scan.stamp;
  last_run_ = scan.run;
  // Before the scan is added: the places that it sees may have been left long before.
  visits_.advance(scan, index);
  bool has_changed = false;
  if (!is_checked_ || is_new_run || (now - last_check_).seconds() >= online_.check_every_s) {
    is_checked_ = true;
    last_check_ = now;
    has_changed = check();
  }
  visits_.add(scan, index);
  keep_scan(std::move(scan));
  follow_sequences(scans_.back(), index);
  has_changed = learn_dirty() || has_changed;
  hold_budget();
  return has_changed;
}

/// All or nothing: the scan's number is its place among those that are kept.
void OnlinePatchLearner::keep_scan(PosedScan scan) {
  const std::size_t bytes = scan_bytes_of(scan);
  reach_m_.push_back(0.0F);
  try {
    scans_.push_back(std::move(scan));
  } catch (...) {
    reach_m_.pop_back();
    throw;
  }
  scan_bytes_ += bytes;
  ++status_.scans_seen;
}

void OnlinePatchLearner::follow_sequences(const PosedScan& scan, std::uint32_t index) {
  SequenceMembership membership(config_.sequences, config_.counting, base_.resolution_m());
  membership.set_scan(scan);
  reach_m_.back() = static_cast<float>(membership.reach_m());
  for (Track& track : tracks_) {
    const auto ended = membership.belongs_to(track.region.rect)
                           ? track.builder.take(index, scan.run, scan.scan.stamp)
                           : track.builder.pass(scan.run, scan.scan.stamp);
    if (ended) keep(track, *ended);
  }
}

void OnlinePatchLearner::keep(Track& track, const Sequence& sequence) const {
  for (const Sequence& part : cut_at(sequence, track.changes, config_.sequences.min_scans)) {
    Kept kept = count_kept(track, part, sequence);
    const bool is_first = track.kept.empty();
    const double since_s =
        is_first ? 0.0 : (kept.info.begin - track.kept.back().info.end).seconds();
    track.kept.push_back(std::move(kept));
    try {
      track.history.append(since_s, track.kept.back().info.begin);
    } catch (...) {
      track.kept.pop_back();  // an entry each
      throw;
    }
  }
  track.is_dirty = true;
}

bool OnlinePatchLearner::check() {
  const std::vector<CellRect> tiles = visits_.take_ended(kWindowM);
  if (tiles.empty()) return false;
  CellRect window;
  for (const CellRect& tile : tiles) window = window.united(tile);
  const bool differs = look_at(window, tiles);
  if (differs) update_tracks();
  for (Track& track : tracks_) {
    if (!track.region.rect.intersected(window).empty()) follow_changes(track);
  }
  return differs;
}

bool OnlinePatchLearner::look_at(const CellRect& window, std::span<const CellRect> tiles) {
  const int context = static_cast<int>(kContextM / base_.resolution_m());
  VisitTable table = visits_.table(window.inflated(context));
  table.filter(config_.contradiction.prior);
  const Grid<std::uint8_t> found = find_contradictions(table, config_.contradiction);
  contradictory_.grow(window);
  bool differs = false;
  for (const CellRect& tile : tiles) {
    for (int y = tile.min.y; y < tile.max.y; ++y) {
      for (int x = tile.min.x; x < tile.max.x; ++x) {
        std::uint8_t& before = contradictory_.at({x, y});
        const std::uint8_t now = found.get({x, y});
        differs = differs || before != now;
        before = now;
      }
    }
  }
  return differs;
}

void OnlinePatchLearner::update_tracks() {
  const std::vector<Region> regions =
      join_regions(grow_regions(contradictory_, config_.regions), base_, config_.regions);
  // Takes the place of the tracks when it is whole: memory may run out meanwhile.
  std::vector<Track> next;
  std::vector<Track> fresh;
  for (const Region& region : regions) {
    const auto same = std::find_if(tracks_.begin(), tracks_.end(), [&](const Track& track) {
      return track.region.rect == region.rect;
    });
    if (same == tracks_.end()) {
      fresh.push_back({region, SequenceBuilder(config_.sequences), {}, {}, {}, true});
      continue;
    }
    // What was counted there holds, whichever of its cells are compared.
    next.push_back(*same);
    if (same->region.cells == region.cells) continue;
    next.back().region = region;
    next.back().is_dirty = true;
  }
  for (Track& track : fresh) {
    take_over(tracks_, track);
    track.changes = changes_of(track);
  }
  recall(fresh);
  for (Track& track : fresh) next.push_back(std::move(track));
  std::sort(next.begin(), next.end(), [](const Track& a, const Track& b) {
    return std::tie(a.region.rect.min.y, a.region.rect.min.x, a.region.rect.max.y,
                    a.region.rect.max.x) < std::tie(b.region.rect.min.y, b.region.rect.min.x,
                                                    b.region.rect.max.y, b.region.rect.max.x);
  });
  tracks_ = std::move(next);
}

/// Sequences whose scans are forgotten come from sub-maps that were here before; what those did not
/// cover stays unknown.
void OnlinePatchLearner::take_over(const std::vector<Track>& before, Track& track) const {
  struct Taken {
    std::size_t from;   // which track
    std::size_t place;  // in it
    std::uint32_t first_scan;
  };
  std::vector<Taken> taken;
  for (std::size_t o = 0; o < before.size(); ++o) {
    if (before[o].region.rect.intersected(track.region.rect).empty()) continue;
    for (std::size_t i = 0; i < before[o].kept.size(); ++i) {
      const std::uint32_t first_scan = before[o].kept[i].first_scan;
      if (first_scan < first_scan_) taken.push_back({o, i, first_scan});
    }
  }
  std::stable_sort(taken.begin(), taken.end(),
                   [](const Taken& a, const Taken& b) { return a.first_scan < b.first_scan; });
  std::vector<std::vector<std::uint32_t>> places;
  for (const Track& old : before) {
    places.emplace_back(old.kept.size(), SequenceHistory::kGone);
  }
  for (const Taken& one : taken) {
    const Kept& kept = before[one.from].kept[one.place];
    places[one.from][one.place] = static_cast<std::uint32_t>(track.kept.size());
    track.kept.push_back({kept.first_scan, kept.last_scan, kept.whole_first, kept.whole_last,
                          kept.info, kept.counts.cropped(track.region.rect)});
  }
  track.history = SequenceHistory(taken.size());
  for (std::size_t o = 0; o < before.size(); ++o) {
    track.history.add(before[o].history, places[o]);
  }
}

/// Sequences of the scans that are still there, the open ones included.
void OnlinePatchLearner::recall(std::span<Track> fresh) {
  if (fresh.empty()) return;
  const double resolution = base_.resolution_m();
  SequenceMembership membership(config_.sequences, config_.counting, resolution);
  const double entry_m =
      config_.sequences.mode == SequenceMode::kEntered ? config_.sequences.entry_margin_m : 0.0;
  for (std::size_t t = 0; t < scans_.size(); ++t) {
    const PosedScan& scan = scans_[t];
    const Eigen::Vector2d laser_m = scan.map_from_laser().translation();
    const double reach_m =
        std::max(static_cast<double>(reach_m_[t]),
                 entry_m + (laser_m - scan.map_from_robot.translation()).norm()) +
        resolution;
    bool is_set = false;
    for (Track& track : fresh) {
      if (distance_m(laser_m, track.region.rect, resolution) > reach_m) continue;
      if (!is_set) membership.set_scan(scan);
      is_set = true;
      if (!membership.belongs_to(track.region.rect)) continue;
      const auto index = first_scan_ + static_cast<std::uint32_t>(t);
      if (const auto ended = track.builder.take(index, scan.run, scan.scan.stamp)) {
        keep(track, *ended);
      }
    }
  }
  for (Track& track : fresh) {
    const PosedScan& newest = scans_.back();
    if (const auto ended = track.builder.pass(newest.run, newest.scan.stamp)) keep(track, *ended);
  }
}

bool OnlinePatchLearner::learn_dirty() {
  std::vector<Track*> dirty;
  for (Track& track : tracks_) {
    if (track.is_dirty) dirty.push_back(&track);
  }
  pool_.for_chunks(dirty.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    Track& track = *dirty[i];
    const std::vector<SequenceInfo> infos = infos_of(track);
    const auto counts_of = [&](std::size_t s) {
      Grid<CellCounts> counts(base_.resolution_m(), track.region.rect);
      for (std::size_t c = 0; c < counts.size(); ++c) {
        const Evidence& cell = track.kept[s].counts.values()[c];
        counts.values()[c] = {static_cast<double>(cell.hits), static_cast<double>(cell.misses)};
      }
      return counts;
    };
    track.submap =
        learn_configurations(track.region, infos, track.history, counts_of, base_, config_);
    track.is_dirty = false;
  });
  for (Track* track : dirty) pool_surplus(*track);
  return !dirty.empty();
}

PatchMap OnlinePatchLearner::map() const {
  PatchMap map;
  map.entry_margin_m = config_.sequences.entry_margin_m;
  map.base =
      online_.extend_base ? visits_.extended(base_, config_.prior, config_.min_evidence) : base_;
  std::vector<Submap> submaps;
  for (const Track& track : tracks_) submaps.push_back(track.submap);
  keep_changing(std::move(submaps), config_, map);
  return map;
}

PatchMap OnlinePatchLearner::finish() {
  const CellRect all = visits_.rect();
  if (!all.empty() && look_at(all, std::span(&all, 1))) update_tracks();
  for (Track& track : tracks_) {
    follow_changes(track);
    if (const auto ended = track.builder.finish()) keep(track, *ended);
  }
  (void)learn_dirty();
  hold_budget();
  return map();
}

}  // namespace strata::patch
