// SPDX-License-Identifier: Apache-2.0
/// When a place that is believed is doubted so much that the robot is looked for elsewhere
/// (docs/theory/patch_localization.md, "A search beside the pose").
#pragma once

#include "core/base/config.hpp"

namespace strata::localization {

struct PlaceWatchConfig {
  bool is_used = true;
  double doubted_score = 0.3;
  int doubted_scans = 5;
  double trusted_score = 0.6;
  int max_scans = 150;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("is_used", c.is_used,
            {.doc = "a robot whose score stays low is looked for in the whole map, beside the pose "
                    "that it has; the place that is found takes over when it is confirmed "
                    "(confirmation) and the pose still doubted, several places together when they "
                    "fit as well and the pose is none of them; false: nothing is looked for"});
    v.field("doubted_score", c.doubted_score,
            {.doc = "a lower score speaks against the pose", .unit = "1", .min = 0.0, .max = 1.0});
    v.field(
        "doubted_scans", c.doubted_scans,
        {.doc =
             "the search begins after so many weighed scans on end with such a score; of several "
             "places the pose must have been none in as many",
         .unit = "scans",
         .min = 1});
    v.field("trusted_score", c.trusted_score,
            {.doc = "from this score on the pose is believed again, and the search ends",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_scans", c.max_scans,
            {.doc = "weighed scans after which a search that found nothing rests, as long as it "
                    "took; after each one in vain twice as long, but at most 1000 scans or as "
                    "long as it took, until the pose is trusted again",
             .unit = "scans",
             .min = 1});
    v.require(c.doubted_score <= c.trusted_score, "doubted_score", "is above trusted_score",
              "lower it");
  }
};

/// Counts the weighed scans of a place that is believed.
class PlaceWatch {
 public:
  enum class Step { kNone, kBegin, kEnd };

  explicit PlaceWatch(const PlaceWatchConfig& config) : config_(config) {}

  /// A start, or another place is believed now.
  void forget() { *this = PlaceWatch(config_); }
  /// The pose is believed, whatever the scans said so far. No search is on.
  void believe();
  /// A scan was weighed, with this score. Whether a search begins with it, or ends.
  [[nodiscard]] Step judge(double score);
  [[nodiscard]] bool is_searching() const { return is_searching_; }
  /// The last scan speaks against the pose, and no search is on, or rests.
  [[nodiscard]] bool is_doubting() const { return doubted_ > 0; }
  /// Since the start some scan did not speak against the pose, while nothing was searched.
  [[nodiscard]] bool was_believed() const { return was_believed_; }

  /// For saved states; the config is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.is_searching_);
    archive(self.doubted_);
    archive(self.searched_);
    archive(self.rest_);
    archive(self.was_believed_);
  }

 private:
  PlaceWatchConfig config_;
  bool is_searching_ = false;
  bool was_believed_ = false;
  int doubted_ = 0;   // scans on end; negative while it rests
  int searched_ = 0;  // scans
  int rest_ = 0;      // scans, of the last one
};

}  // namespace strata::localization
