// SPDX-License-Identifier: Apache-2.0
// What a localizer makes of a scan that is weighed.
#include <algorithm>
#include <cmath>

#include "core/localization/localizer.hpp"
#include "core/localization/pose_spread.hpp"

namespace strata::localization {
namespace {

constexpr double kLongAgo_s = 1e12;

}  // namespace

/// What the other scanners saw meanwhile, each in turn, as if the robot had stood still since.
void Localizer::weigh_companions(const Observation& observation, double tempering) {
  for (const CompanionScans::Companion* companion : companions_.take(observation)) {
    const Scan* judged = judged_part(companion->scan);
    if (judged == nullptr) continue;
    (void)model_->log_likelihoods(*judged, {tempering, companion->share, is_place_sure()},
                                  particles_, log_likelihood_, *pool_);
    (void)reweigh(particles_, log_likelihood_);
    const Pose2Gaussian pose = estimate(particles_);
    if (const PatchStates* states = model_->patch_states()) states->absorb(pose, particles_);
    if (own_model_ == nullptr) continue;
    own_model_->learn(companion->observation,
                      {pose.mean * companion->now_from_then, pose.covariance}, trust());
  }
}

PoseTrust Localizer::trust() const {
  return {score_.value(), is_ambiguous() || is_contested() || monitor_.health().is_in_doubt ||
                              beyond_.is_outside()};
}

/// What the weighed part of the scan says of the pose that was found with it.
void Localizer::judge(const Scan& judged, const Pose2Gaussian& pose, double likelihood_per_beam) {
  const double share = beyond_.judged_share();
  const InlierShares shares =
      model_->inlier_shares_given(result_.submaps, judged, pose.mean, particles_).among_all(share);
  const double stddev_m = position_stddev(pose);
  if (is_open() || annealed_updates_ < config_.global_start.annealing_updates) score_.doubt();
  score_.add(judged, share, pose.mean, shares, result_.submaps, particles_, *model_, stddev_m);
  monitor_.add(likelihood_per_beam, shares, stddev_m, score_.value());
  if (is_open()) return;
  if (confirmation_.judge(score_.value())) seek(true);
  if (!is_ambiguous() && !watch_.is_doubting()) finder_.rest();
}

/// Since the last weighed scan. A filter that has not seen one knows no state yet: of what follows
/// the time it then learns what is usual now.
double Localizer::elapsed_s(const PatchStates& states, Stamp now) const {
  if (last_weighed_) return std::max(0.0, (now - *last_weighed_).seconds());
  return states.follows_time() ? kLongAgo_s : 0.0;
}

/// Several places judge differently: then all beams are weighed.
const Scan* Localizer::judged_part(const Scan& scan) {
  if (is_open() || annealed_updates_ < config_.global_start.annealing_updates) {
    beyond_.judge_nothing();
    return &scan;
  }
  const Pose2Gaussian pose = estimate(particles_);
  return beyond_.judged(scan, *model_, pose.mean, position_stddev(pose));
}

Pose2Gaussian Localizer::weigh(const Observation& observation, const Pose2& moved_before) {
  ++step_;
  follow_motion(moved_before);
  const Stamp now = observation.scan.stamp;
  const PatchStates* states = model_->patch_states();
  if (states != nullptr) states->tell_time(now, particles_);
  if (is_ambiguous() || watch_.is_doubting()) finder_.add(moved_, observation.scan);
  if (is_seeking_) find_places();
  if (states != nullptr) states->predict(elapsed_s(*states, now), seed_, step_, particles_, *pool_);

  log_likelihood_.resize(particles_.size());
  Weighing weighing{model_->tempering() * annealing() * beyond_.tempering(monitor_.is_outdated())};
  weighing.is_place_sure = is_place_sure();
  if (turns_.alive() > 1) {
    weigh_companions(observation, weighing.tempering);
    weighing.share = companions_.own_share();
  }
  const Scan* judged = judged_part(observation.scan);
  std::size_t beams = 0;
  if (judged != nullptr) {
    beams = model_->log_likelihoods(*judged, weighing, particles_, log_likelihood_, *pool_);
  } else {
    std::fill(log_likelihood_.begin(), log_likelihood_.end(), 0.0);
  }
  const double log_mean = reweigh(particles_, log_likelihood_);
  const Pose2Gaussian pose = places_.is_active() ? judge_places() : estimate(particles_);
  if (states != nullptr && judged != nullptr) states->absorb(pose, particles_);
  pool_beliefs();
  if (beams > 0 && std::isfinite(log_mean)) {
    judge(*judged, pose, std::exp(log_mean * weighing.tempering / static_cast<double>(beams)));
  } else {
    score_.drive_unseen(moved_.translation().norm());
    if (judged == nullptr) monitor_.add_unjudged(beyond_.judged_share(), position_stddev(pose));
  }
  if (own_model_ != nullptr) own_model_->learn(observation, pose, trust());
  settle_motion(pose);
  beyond_.settle();
  last_weighed_ = now;
  turns_.use();
  moved_ = Pose2{};
  scans_since_weighed_ = 0;
  must_weigh_ = false;
  ++annealed_updates_;
  // One place is left: nothing has to be kept apart any more.
  if (is_one_place(pose, config_.recovery.uncertain_stddev_m)) {
    annealed_updates_ = std::max(annealed_updates_, config_.global_start.annealing_updates);
    monitor_.search_ends();
  }
  return pose;
}

/// Between weighed scans beliefs and weights stay: once is enough.
void Localizer::pool_beliefs() {
  const PatchStates* states = model_->patch_states();
  if (states != nullptr) states->posterior(particles_, result_.submaps);
  are_beliefs_pooled_ = true;
}

}  // namespace strata::localization
