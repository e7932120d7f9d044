// SPDX-License-Identifier: Apache-2.0
/// The global search as a filter uses it: in its own map, for the last metres of scans.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <vector>

#include "core/base/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/global_search.hpp"
#include "core/localization/place_hypotheses.hpp"
#include "core/localization/place_watch.hpp"
#include "core/localization/start_confirmation.hpp"
#include "core/scan/scan.hpp"

namespace strata::localization {

struct PlaceFinderConfig {
  bool is_used = true;
  int local_scans = 10;
  int patience = 10;
  GlobalSearchConfig search{.max_candidates = 300};
  PlaceHypothesesConfig places;
  StartConfirmationConfig confirmation;
  PlaceWatchConfig watch;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("is_used", c.is_used,
            {.doc = "a start without a pose, and what recovers, looks for the scans in the whole "
                    "map, and is ambiguous until one place is left; false: particles anywhere "
                    "(global_start)",
             .preset = {"paper-patch", "false"}});
    v.field("local_scans", c.local_scans,
            {.doc = "weighed scans that are looked for together", .unit = "scans", .min = 1});
    v.field(
        "patience", c.patience,
        {.doc = "weighed scans to wait for more to look for, while more places fit than are kept",
         .unit = "scans",
         .min = 0});
    v.group("search", c.search, "which places are tried");
    v.group("places", c.places, "how they are told apart");
    v.group("confirmation", c.confirmation, "when the one that is left is believed");
    v.group("watch", c.watch, "when a robot that is believed somewhere is looked for elsewhere");
  }
};

/// Keeps the end points of the last weighed scans by odometry, and searches for all of them.
class PlaceFinder {
 public:
  explicit PlaceFinder(const PlaceFinderConfig& config) : config_(config) {}

  /// The map of later searches. Its table is made when it is first needed, and kept when the same
  /// map comes again.
  void set_map(const ReflectionGrid& map);
  /// That of another one, with its table.
  void share_map(const PlaceFinder& other) {
    if (map_ == other.map_) return;
    map_ = other.map_;
    search_ = other.search_;
  }
  [[nodiscard]] bool has_map() const { return map_ != nullptr && map_->size() > 0; }

  void forget_scans() { scans_.clear(); }
  /// Nothing is looked for any more. The table, as large as the map, is made again when it is.
  void rest() {
    scans_.clear();
    search_.reset();
  }
  /// The robot has moved since the last scan that was added, and sees this.
  void add(const Pose2& motion, const Scan& scan);
  /// Places where the scans fit; nothing while there are more of them than are kept and scans are
  /// to be waited for. `waited`: scans so far.
  [[nodiscard]] std::vector<PlaceSeed> find(int waited);

  /// For saved states; config and map are told.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.scans_);
  }

 private:
  struct Placed {
    Pose2 now_from_then;
    Endpoints points;
    template <class Self, class Archive>
    static void state(Self& self, Archive& archive) {
      archive(self.now_from_then);
      archive(self.points);
    }
  };
  PlaceFinderConfig config_;
  std::shared_ptr<const ReflectionGrid> map_;
  std::shared_ptr<const GlobalSearch> search_;
  std::deque<Placed> scans_;  // the newest last
};

}  // namespace strata::localization
