// SPDX-License-Identifier: Apache-2.0
/// Learns a patch map while scans come, in bounded time and memory. [stachniss2005patch] and
/// [stachniss2003chapter] name it as future work: docs/theory/patch_maps.md, "Online learning".
///
/// Once nobody has looked at a place for longer than a visit's gap, its visits are tested for
/// contradictions, and sub-maps appear, grow or go. An observation sequence is counted and its
/// sub-map clustered anew when it ends. The scans themselves are kept as far as memory allows, so
/// that a new sub-map knows what was seen there before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/config.hpp"
#include "core/base/parallel.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_learner_config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/patch/sequence_history.hpp"
#include "core/patch/visit_store.hpp"
#include "core/scan/drop_out_watch.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch {

struct OnlineConfig {
  double check_every_s = 5.0;
  double memory_mb = 256.0;
  int max_visits = 16;
  int max_sequences = 40;
  bool extend_base = true;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("check_every_s", c.check_every_s,
            {.doc = "places that the robot has left are looked over for changes this often",
             .unit = "s",
             .min = 0.0});
    v.field("memory_mb", c.memory_mb,
            {.doc = "budget for visits, scans and configurations; the oldest scans go first, then "
                    "sequences of one configuration become one, then visits and configurations "
                    "are forgotten",
             .unit = "MB",
             .min = 1.0,
             .when = "the robot has little memory, or a large building to remember"});
    v.renamed("most_visits", "max_visits");
    v.field("max_visits", c.max_visits,
            {.doc = "visits kept of a cell; of more, the oldest of the more frequent kind go",
             .min = 2});
    v.renamed("most_sequences", "max_sequences");
    v.field("max_sequences", c.max_sequences,
            {.doc = "sequences kept of a sub-map; of more, two of one configuration become one",
             .min = 4});
    v.field(
        "extend_base", c.extend_base,
        {.doc = "fill in what the static map does not know, such as the room behind a door that "
                "was closed when it was made: else nobody can tell that the door is open"});
  }
};

/// What an online learner holds and did.
struct OnlineStatus {
  std::size_t bytes = 0;  ///< of everything that grows with scans, the map it makes included
  std::size_t scans = 0;  ///< kept, of all that came
  std::size_t scans_seen = 0;
  std::size_t sequences = 0;  ///< kept
  std::size_t pooled_sequences = 0;
  std::size_t forgotten_configurations = 0;
  bool is_over_budget = false;  ///< the area alone takes more than the budget
};

/// Scans must come ordered by run, then time. Bit-identical at any number of threads. Not
/// thread-safe.
class OnlinePatchLearner {
 public:
  /// base: the static map, whose lattice the sub-maps share. Throws ConfigError. threads: as
  /// WorkerPool.
  OnlinePatchLearner(const PatchLearnerConfig& config, const OnlineConfig& online,
                     ReflectionGrid base, int threads = 1);

  /// A newer static map on the same lattice. Configurations take it over when they are learned
  /// again.
  void set_base(ReflectionGrid base) { base_ = std::move(base); }

  /// Adds a scan (its static probabilities are not needed); a pose that is not finite is left out.
  /// True when the map changed. Most calls cost O(beams x cells a beam crosses); one that ends a
  /// sequence also O(scans of the sequence x beams) and the clustering of at most max_sequences
  /// vectors; a check O(cells of a window of 20 m and their visits); a new sub-map O(kept scans in
  /// reach x beams). None grows with the length of the run.
  bool add(PosedScan scan);
  /// Where a scan is now known to have been taken; nothing: not known, it goes along with the scan
  /// before it in its run.
  using PoseOf = std::function<std::optional<Pose2>(const PosedScan&)>;
  /// The scans that are kept, where they are now known to have been taken; nothing when none moved
  /// by half a cell or more. O(scans).
  [[nodiscard]] std::optional<std::vector<PosedScan>> moved_scans(const PoseOf& pose_of) const;
  /// A loop closure moved scans: all of them are counted anew where they were taken, and the map is
  /// that of a learner that was given these poses at once. Where scans are forgotten already, only
  /// what comes later is better: those that are kept are moved, and what was counted stays.
  /// False, and nothing is done, when none moved by half a cell or more. O(add of each kept scan).
  bool move_scans(const PoseOf& pose_of);
  /// Adds the scans that `other` has been given since this one: it was given the same ones before,
  /// at other poses. False, and nothing is done, where `other` has forgotten some of those. O(add
  /// of each).
  bool catch_up_with(const OnlinePatchLearner& other, const PoseOf& pose_of);
  /// The map as of now: sub-maps with at least two configurations, over the base as it was given
  /// and, with extend_base, what the scans add to it. O(its cells).
  [[nodiscard]] PatchMap map() const;
  /// Ends the open sequences, looks everywhere and returns the map: that of PatchLearner as long as
  /// nothing was forgotten, where beams without return say nothing; what they say is known here by
  /// what came before only (DropOutWatch). Scans may follow.
  PatchMap finish();

  [[nodiscard]] const OnlineStatus& status() const { return status_; }
  /// What beams without return are taken for, until now.
  [[nodiscard]] DropOuts drop_outs() const { return drop_outs_.found(); }
  [[nodiscard]] const ReflectionGrid& base() const { return base_; }
  /// Whether some scan is forgotten, so that what it said cannot be learned again.
  [[nodiscard]] bool has_forgotten() const { return first_scan_ > 0; }
  /// Of the last scan added; 0 before the first.
  [[nodiscard]] int last_run() const { return last_run_; }

  /// Everything that it holds, as bytes: a new learner with the same settings that restores them
  /// goes on bit for bit. O(bytes).
  [[nodiscard]] std::vector<std::uint8_t> save_state() const;
  /// To be called before anything is added. place: of the bytes, for errors. Throws InputError for
  /// bytes of another version or resolution, DamageError for damaged ones; the learner is of no use
  /// then.
  void restore_state(std::span<const std::uint8_t> bytes, const std::string& place);

 private:
  /// What one sequence counted. Floats: half of the memory, and counts below 2^24 are exact.
  struct Evidence {
    float hits = 0.0F;
    float misses = 0.0F;
  };
  struct Kept {
    std::uint32_t first_scan = 0;
    std::uint32_t last_scan = 0;
    std::uint32_t whole_first = 0;  // scan of the sequence that this is a part of, if it was cut
    std::uint32_t whole_last = 0;
    SequenceInfo info;
    Grid<Evidence> counts;
  };
  struct Track {
    Region region;
    SequenceBuilder builder;
    std::vector<Kept> kept;
    SequenceHistory history;  // an entry each
    Submap submap;
    bool is_dirty = false;
    std::vector<std::uint32_t> changes{};  // the first scan after each, as far as known
  };

  template <class Self, class Archive>
  static void state(Self& self, Archive& archive, bool has_changes);
  [[nodiscard]] std::vector<Pose2> poses_by(const PoseOf& pose_of) const;
  /// As it was made, but for the base.
  void begin_again();
  /// Whether what was restored fits together.
  [[nodiscard]] bool has_sound_scans() const;
  [[nodiscard]] bool is_sound(const Track& track) const;
  void keep_scan(PosedScan scan);
  void follow_sequences(const PosedScan& scan, std::uint32_t index);
  void keep(Track& track, const Sequence& sequence) const;
  [[nodiscard]] Kept count_kept(const Track& track, const Sequence& part,
                                const Sequence& whole) const;
  [[nodiscard]] static std::vector<SequenceInfo> infos_of(const Track& track);
  [[nodiscard]] std::vector<std::uint32_t> changes_of(const Track& track) const;
  [[nodiscard]] Sequence sequence_within(const Track& track, std::uint32_t first,
                                         std::uint32_t last) const;
  /// Cuts kept sequences where their sub-map turns out to have changed in view.
  void follow_changes(Track& track) const;
  /// before: the changes as they were known until now.
  void cut_again(Track& track, std::span<const std::uint32_t> before) const;
  [[nodiscard]] bool check();
  [[nodiscard]] bool look_at(const CellRect& window, std::span<const CellRect> tiles);
  void update_tracks();
  void recall(std::span<Track> fresh);
  void take_over(const std::vector<Track>& before, Track& track) const;
  [[nodiscard]] bool learn_dirty();
  void pool_surplus(Track& track);
  void forget_configuration();
  void hold_budget();
  void forget_scans(std::size_t bytes_to_free);
  [[nodiscard]] static std::size_t scan_bytes_of(const PosedScan& scan);
  [[nodiscard]] std::size_t count_bytes();

  PatchLearnerConfig config_;
  OnlineConfig online_;
  WorkerPool pool_;
  ReflectionGrid base_;
  DropOutWatch drop_outs_;
  VisitStore visits_;
  Grid<std::uint8_t> contradictory_;
  std::vector<Track> tracks_;
  std::vector<PosedScan> scans_;  // the newest ones, the first is number first_scan_
  std::vector<float> reach_m_;    // of each
  std::uint32_t first_scan_ = 0;
  std::size_t scan_bytes_ = 0;
  int max_sequences_;
  bool is_checked_ = false;
  Stamp last_check_;
  int last_run_ = 0;
  OnlineStatus status_;
};

}  // namespace strata::patch
