// SPDX-License-Identifier: Apache-2.0
/// Whether a place that a search found has shown itself right
/// (docs/theory/patch_localization.md, "Several places").
#pragma once

#include "core/base/config.hpp"

namespace strata::localization {

struct StartConfirmationConfig {
  double confirmed_score = 0.6;
  double refuted_score = 0.3;
  int search_again_scans = 15;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("confirmed_score", c.confirmed_score,
            {.doc = "the one place that is left is believed once its score has been so high; until "
                    "then the pose is ambiguous still",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("refuted_score", c.refuted_score,
            {.doc = "a lower score speaks against the place that is left",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.removed("refuted_scans", "a place that was believed is watched by global_search.watch");
    v.field("search_again_scans", c.search_again_scans,
            {.doc = "the whole map is searched again, beside the place that is left, after so many "
                    "weighed scans that have not confirmed it and while its score is below "
                    "refuted_score; then after twice as many, and so on",
             .unit = "scans",
             .min = 1});
    v.require(c.refuted_score <= c.confirmed_score, "refuted_score", "is above confirmed_score",
              "lower it");
  }
};

/// The others were refuted by scans that share what is wrong with the map, so the place that is
/// left may be the least wrong of many. It counts when it fits by itself.
class StartConfirmation {
 public:
  explicit StartConfirmation(const StartConfirmationConfig& config) : config_(config) {}

  /// Somebody said where the robot is: nothing is to be confirmed.
  void tell() { *this = StartConfirmation(config_); }
  /// A search begins: what it finds has to be confirmed.
  void search();
  /// A scan was weighed, and one place is left, with this score. Whether to search again now.
  [[nodiscard]] bool judge(double score);
  /// The place that is left is not confirmed yet.
  [[nodiscard]] bool is_pending() const { return is_pending_; }

  /// For saved states; the config is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.is_pending_);
    archive(self.scans_);
    archive(self.patience_);
  }

 private:
  StartConfirmationConfig config_;
  bool is_pending_ = false;
  int scans_ = 0;     // since the last search
  int patience_ = 0;  // scans until the next search
};

}  // namespace strata::localization
