// SPDX-License-Identifier: Apache-2.0
/// Going on where the map ends: what it says nothing of is not weighed, and the scans themselves
/// tell how the robot moves (docs/theory/patch_localization.md, "Where the map ends").
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/localization/motion_model.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/scan/scan.hpp"
#include "core/tracking/tracker.hpp"

namespace strata::localization {

struct BeyondMapConfig {
  bool is_used = true;
  double begin_share = 0.1;
  double coast_share = 0.5;
  double noise_share = 0.03;
  double max_stddev_m = 1.0;
  double outdated_tempering = 8.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("is_used", c.is_used,
            {.doc = "leave out beams of which the map says nothing, and let scans tell the motion "
                    "there; false: they are weighed as if nothing stood there, and odometry alone "
                    "tells the motion"});
    v.field("begin_share", c.begin_share,
            {.doc = "from this share of the beams on those that the map does not judge are left "
                    "out, and scans are matched to the last metres",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("coast_share", c.coast_share,
            {.doc = "from this share on the scan is not weighed at all, while it matches the last "
                    "metres",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("noise_share", c.noise_share,
            {.doc = "variance of a motion that scans tell, as a share of that of odometry",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_stddev_m", c.max_stddev_m,
            {.doc = "above this spread of the particles nothing is left out: what the map judges "
                    "depends on where the robot is",
             .unit = "m",
             .min = 0.0});
    v.removed("search_after_m", "nothing is looked for on the way back into the map");
    v.removed("drift", "nothing is looked for on the way back into the map");
    v.field(
        "outdated_tempering", c.outdated_tempering,
        {.doc = "beside the map's end, where it is outdated too and scans tell the motion, the "
                "log-likelihood is divided by this besides: what is wrong there is wrong for many "
                "beams alike",
         .unit = "1",
         .min = 1.0});
    v.require(c.begin_share <= c.coast_share, "begin_share", "is above coast_share", "lower it");
  }
};

/// A tracker [hess2016real] runs from when the first beams are not judged until all are judged for
/// a while, so a robot that stays in its map pays for nothing but the judging.
class BeyondMap {
 public:
  explicit BeyondMap(const BeyondMapConfig& config) : config_(config) {}

  /// A start, or a new run: nothing that was seen before says how the robot moves.
  void reset();
  /// Every scan, in order. The motion since the scan before as scans tell it, before_from_now;
  /// nothing when they do not, or where the map judges well: among people a tracker slides, and
  /// there the map says more.
  [[nodiscard]] std::optional<Pose2> follow(const Observation& observation);
  /// The part of a scan to weigh: the scan itself, or a copy without the beams that the model does
  /// not judge from there; null: not to be weighed. Valid until the next call.
  [[nodiscard]] const Scan* judged(const Scan& scan, const SensorModel& model,
                                   const Pose2& map_from_robot, double stddev_m);
  /// A scan is weighed whole, since nobody can say where the map ends from there.
  void judge_nothing() {
    unjudged_share_ = 0.0;
    leads_ = false;
  }
  /// The last scan that was judged was weighed in part, or not at all.
  [[nodiscard]] bool is_beyond() const {
    return config_.is_used && unjudged_share_ >= config_.begin_share;
  }
  /// ... of which the map says nothing of coast_share of the beams.
  [[nodiscard]] bool is_outside() const {
    return config_.is_used && unjudged_share_ >= config_.coast_share;
  }
  /// Of the beams of that scan that say something those that the map judges; 1 when it is weighed
  /// whole.
  [[nodiscard]] double judged_share() const { return is_beyond() ? 1.0 - unjudged_share_ : 1.0; }
  /// Noise of a motion that was told by scans, all of them, since the last weighed scan.
  [[nodiscard]] MotionModelConfig noise(const MotionModelConfig& of_odometry) const;
  /// Whether it was; odometry is not needed then.
  [[nodiscard]] bool is_told() const { return matched_ > 0 && unmatched_ == 0; }
  /// Divides the log-likelihood besides; is_outdated: few beams are inliers of late.
  [[nodiscard]] double tempering(bool is_outdated) const {
    return is_outdated && is_told() ? config_.outdated_tempering : 1.0;
  }
  /// A scan was weighed, or its turn is over: what comes is the next motion.
  void settle();

  /// For saved states; the config is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    bool is_tracking = self.tracker_.has_value();
    archive(is_tracking);
    if constexpr (Archive::kReads) {
      self.tracker_.reset();
      if (is_tracking) self.begin();
    }
    if (is_tracking) archive(*self.tracker_);
    archive(self.last_);
    archive(self.scans_);
    archive(self.matched_);
    archive(self.unmatched_);
    archive(self.judged_in_a_row_);
    archive(self.unjudged_share_);
    archive(self.leads_);
    if constexpr (Archive::kReads) {
      if (self.tracker_ && !self.tracker_->is_sound(self.scans_)) {
        archive.fail("has a damaged local map");
      }
    }
  }

 private:
  void begin();

  BeyondMapConfig config_;
  std::optional<slam::Tracker> tracker_;  // in a frame of its own, which begins with it
  std::optional<Pose2> last_;             // where the last scan was, in that frame
  std::size_t scans_ = 0;                 // of the tracker
  std::size_t matched_ = 0;               // scans since the last weighed one
  std::size_t unmatched_ = 0;
  int judged_in_a_row_ = 0;
  double unjudged_share_ = 0.0;
  bool leads_ = false;  // what scans tell of the motion is followed
  Scan part_;
  std::vector<std::uint8_t> is_unjudged_;
};

}  // namespace strata::localization
