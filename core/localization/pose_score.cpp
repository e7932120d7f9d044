// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_score.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/localization/score_calibration.hpp"

namespace strata::localization {
namespace {

/// Further than 0.5 m, which counts as wrong, and near enough for the same walls to be in sight.
constexpr double kElsewhere_m = 0.7;
constexpr double kUsualRate = 0.2;
constexpr double kLongRate = 0.03;
/// With fewer beams judged a share of them would be noise.
constexpr double kLeastJudged = 0.05;
constexpr double kLeastSpread_m = 0.02;
constexpr double kUnseen_m = 10.0;

double least(const std::array<double, 8>& margins) {
  return *std::min_element(margins.begin(), margins.end());
}

}  // namespace

double score_log_odds(const ScoreEvidence& evidence) {
  double log_odds = kScoreBias;
  for (std::size_t i = 0; i < ScoreEvidence::kParts; ++i) {
    log_odds += kScoreWeights[i] * evidence.part[i];
  }
  return log_odds;
}

double calibrated_score(const ScoreEvidence& evidence) {
  return 1.0 / (1.0 + std::exp(kScoreCaution - score_log_odds(evidence)));
}

double next_doubt(double doubt, double log_odds) {
  constexpr double kRise = 0.2;
  constexpr double kScans = 40.0;
  return log_odds < 0.0 ? std::min(1.0, doubt + kRise) : doubt * std::exp(-1.0 / kScans);
}

void PoseScore::Averages::follow(const Averages& now, double rate) {
  for (double InlierShares::*share :
       {&InlierShares::inlier, &InlierShares::judged, &InlierShares::met, &InlierShares::at_surface,
        &InlierShares::stopped}) {
    shares.*share += rate * (now.shares.*share - shares.*share);
  }
  for (std::size_t k = 0; k < kDirections; ++k) {
    inlier_margin[k] += rate * (now.inlier_margin[k] - inlier_margin[k]);
    surface_margin[k] += rate * (now.surface_margin[k] - surface_margin[k]);
  }
}

void PoseScore::add(const Scan& scan, double share, const Pose2& map_from_robot,
                    const InlierShares& here, const std::vector<SubmapBelief>& submaps,
                    const ParticleSet& particles, const SensorModel& model,
                    double position_stddev_m) {
  Averages now;
  now.shares = here;
  for (std::size_t k = 0; k < kDirections; ++k) {
    const double angle = static_cast<double>(k) * 2.0 * std::numbers::pi / kDirections;
    const Pose2 elsewhere{map_from_robot.x + kElsewhere_m * std::cos(angle),
                          map_from_robot.y + kElsewhere_m * std::sin(angle), map_from_robot.theta};
    const InlierShares there =
        model.inlier_shares_given(submaps, scan, elsewhere, particles).among_all(share);
    now.inlier_margin[k] = here.inlier - there.inlier;
    now.surface_margin[k] = here.at_surface - there.at_surface;
  }
  const double mean_rate = 1.0 / static_cast<double>(++count_);
  usual_.follow(now, std::max(kUsualRate, mean_rate));
  long_.follow(now, std::max(kLongRate, mean_rate));

  const double usually_judged = std::max(usual_.shares.judged, kLeastJudged);
  const double judged = std::max(here.judged, kLeastJudged);
  auto& part = evidence_.part;
  part[ScoreEvidence::kMet] = usual_.shares.met / usually_judged;
  part[ScoreEvidence::kAtSurface] = usual_.shares.at_surface / usually_judged;
  part[ScoreEvidence::kStopped] = usual_.shares.stopped / usually_judged;
  part[ScoreEvidence::kJudged] = usual_.shares.judged;
  part[ScoreEvidence::kMarginSurface] = least(usual_.surface_margin);
  part[ScoreEvidence::kMarginLong] = least(long_.inlier_margin);
  part[ScoreEvidence::kMarginSurfaceLong] = least(long_.surface_margin);
  part[ScoreEvidence::kSpread] = std::log(std::max(position_stddev_m, kLeastSpread_m));
  part[ScoreEvidence::kMetNow] = here.met / judged;
  part[ScoreEvidence::kAtSurfaceNow] = here.at_surface / judged;
  part[ScoreEvidence::kMarginNow] = least(now.inlier_margin);
  double& doubt = part[ScoreEvidence::kDoubt];
  const double before = std::exchange(doubt, 0.0);
  doubt = next_doubt(before, score_log_odds(evidence_));
  value_ = calibrated_score(evidence_);
}

void PoseScore::drive_unseen(double distance_m) { value_ *= std::exp(-distance_m / kUnseen_m); }

}  // namespace strata::localization
