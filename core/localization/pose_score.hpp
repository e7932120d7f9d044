// SPDX-License-Identifier: Apache-2.0
/// How sure a pose is: the probability that it is within 0.5 m of the truth, from what the beams
/// say of it (docs/theory/localization_score.md).
#pragma once

#include <array>
#include <cstddef>

#include "core/geometry/pose2.hpp"
#include "core/localization/inlier_shares.hpp"
#include "core/localization/sensor_model.hpp"

namespace strata::localization {

/// What the score is made of. Shares are of the beams that the map judges, 0 to 1; a margin is how
/// much larger the share at the pose is than at the best of eight places 0.7 m from it, so that
/// beams count which fit there as well, as those to the side walls of a corridor, for nothing: -1
/// to 1, near 0 where some direction is left open. "Usual" averages forget over 5 weighed scans,
/// "long" ones over 33.
struct ScoreEvidence {
  enum Part : std::size_t {
    kMet,            ///< usual share that ends at the first obstacle on its way
    kAtSurface,      ///< ... near any surface
    kStopped,        ///< ... at no surface, before the first one
    kJudged,         ///< usual share of all beams that the map judges
    kMarginSurface,  ///< usual margin of the beams near any surface
    kMarginLong,     ///< long margin of the beams that end where expected
    kMarginSurfaceLong,
    kSpread,  ///< ln of the position's standard deviation in metres, at least 0.02 m
    kMetNow,  ///< of this scan alone: what a robot that was carried away sees at once
    kAtSurfaceNow,
    kMarginNow,
    kDoubt,  ///< 1 while it is not known at all where the robot is; next_doubt()
    kParts
  };
  std::array<double, kParts> part{};
};

/// ln of how much likelier than wrong a pose of such evidence is right, by kScoreWeights
/// (score_calibration.hpp) [nats].
[[nodiscard]] double score_log_odds(const ScoreEvidence& evidence);
/// Its calibrated probability, 0 to 1: of log-odds that are lower by kScoreCaution.
[[nodiscard]] double calibrated_score(const ScoreEvidence& evidence);

/// The doubt after a weighed scan of which the other parts alone have these log-odds. A robot that
/// was lost may have come to a place that looks like its own: beams that fit count in full only
/// when they have done so for a while. Doubt rises over five scans that speak against the pose, and
/// wears off over 40 that speak for it.
[[nodiscard]] double next_doubt(double doubt, double log_odds);

/// Follows one run. Deterministic; a scan costs nine times SensorModel::inlier_shares.
class PoseScore {
 public:
  /// At a start: nothing was seen, and the score is 0.
  void reset() { *this = PoseScore(); }
  /// The robot may be anywhere: nobody said where, and no place has won yet.
  void doubt() { evidence_.part[ScoreEvidence::kDoubt] = 1.0; }
  /// A scan was weighed, or that share of its beams. here: the shares of all of them at the pose,
  /// the mean of `particles`, whose position has that standard deviation. submaps: what they
  /// believe of the changeable areas, pooled.
  void add(const Scan& scan, double share, const Pose2& map_from_robot, const InlierShares& here,
           const std::vector<SubmapBelief>& submaps, const ParticleSet& particles,
           const SensorModel& model, double position_stddev_m);
  /// The robot drove on without seeing anything: after 10 m of that 1/e of the score is left.
  void drive_unseen(double distance_m);
  /// 0 to 1; 0 before the first weighed scan.
  [[nodiscard]] double value() const { return value_; }
  /// Of the last weighed scan, for calibration.
  [[nodiscard]] const ScoreEvidence& evidence() const { return evidence_; }

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.usual_);
    archive(self.long_);
    archive(self.count_);
    archive(self.evidence_);
    archive(self.value_);
  }

 private:
  static constexpr std::size_t kDirections = 8;
  /// Sums of the shares at the pose and their margins in each direction.
  struct Averages {
    InlierShares shares;
    std::array<double, kDirections> inlier_margin{};
    std::array<double, kDirections> surface_margin{};
    void follow(const Averages& now, double rate);
  };
  Averages usual_;
  Averages long_;
  std::size_t count_ = 0;
  ScoreEvidence evidence_;
  double value_ = 0.0;
};

}  // namespace strata::localization
