// SPDX-License-Identifier: Apache-2.0
#include "core/localization/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strata::localization {

namespace {

/// Beams that something new stops may be up to this share of those judged for the others to speak
/// alone: where nearly all are stopped, few are left.
constexpr double kMaxStopped = 0.75;
/// From this score on a pose is likelier right than wrong.
constexpr double kLikelyRight = 0.5;
/// Of the pace at which the long averages follow otherwise: a pose that stays wrong must not become
/// the usual one, and a building that was rebuilt must.
constexpr double kPaceWhileLost = 0.1;

/// Moves the average of each share by `rate` of the way to the new one.
void follow(double rate, const InlierShares& now, InlierShares& average) {
  for (double InlierShares::*share :
       {&InlierShares::inlier, &InlierShares::judged, &InlierShares::met, &InlierShares::at_surface,
        &InlierShares::stopped}) {
    average.*share += rate * (now.*share - average.*share);
  }
}

double inliers_of_judged(const InlierShares& shares) {
  return shares.judged > 0.0 ? shares.inlier / shares.judged : 1.0;
}

}  // namespace

void HealthMonitor::add(double likelihood_per_beam, const InlierShares& shares,
                        double position_stddev_m, std::optional<double> score) {
  ++count_;
  const double mean_rate = 1.0 / static_cast<double>(count_);
  const double fast = std::max(config_.fast_rate, mean_rate);
  const double slow = std::max(config_.slow_rate, mean_rate);
  likelihood_fast_ += fast * (likelihood_per_beam - likelihood_fast_);
  likelihood_slow_ += slow * (likelihood_per_beam - likelihood_slow_);
  LocalizationHealth& h = health_;
  h.likelihood_per_beam = likelihood_per_beam;
  follow(fast, shares, fast_);
  follow(h.state == HealthState::kLost ? kPaceWhileLost * slow : slow, shares, slow_);
  h.inlier_share = inliers_of_judged(shares);
  h.inlier_share_fast = inliers_of_judged(fast_);
  h.inlier_share_slow = inliers_of_judged(slow_);
  h.judged_share_fast = fast_.judged;
  h.likelihood_ratio = likelihood_slow_ > 0.0 ? likelihood_fast_ / likelihood_slow_ : 1.0;
  h.position_stddev_m = position_stddev_m;
  const bool is_known = h.judged_share_fast >= kMinJudged;
  const bool is_likely = score && *score >= kLikelyRight;
  const bool is_lost = is_known && !is_likely && is_contradicted();
  h.is_in_doubt =
      is_lost || (is_known && h.inlier_share_fast < config_.lost_share * h.inlier_share_slow);
  if (is_lost) {
    h.state = HealthState::kLost;
  } else if (position_stddev_m > config_.uncertain_stddev_m) {
    h.state = HealthState::kConverging;
  } else if (!is_known || is_outdated()) {
    h.state = HealthState::kMapOutdated;
  } else {
    h.state = HealthState::kGood;
  }
  // Looking for a better place must not wait until the pose is surely wrong.
  if (h.is_in_doubt || (!is_known && doubtful_in_a_row_ < 0)) {
    ++doubtful_in_a_row_;
  } else {
    doubtful_in_a_row_ = 0;
  }
}

void HealthMonitor::add_unjudged(double judged_share, double position_stddev_m) {
  LocalizationHealth& h = health_;
  h.position_stddev_m = position_stddev_m;
  if (fast_.judged > 0.0) {
    // All shares fall alike, so that those of the judged beams stay what they were.
    const double part = std::clamp(judged_share, 0.0, fast_.judged) / fast_.judged;
    follow(config_.fast_rate * (1.0 - part), {}, fast_);
    h.judged_share_fast = fast_.judged;
  }
  if (h.state == HealthState::kLost) return;
  if (position_stddev_m > config_.uncertain_stddev_m) {
    h.state = HealthState::kConverging;
  } else if (h.judged_share_fast < kMinJudged) {
    h.state = HealthState::kMapOutdated;
  }
}

/// Whether all readings of the map contradict the pose: rays, surfaces, and that of the beams which
/// nothing new stopped. Where furniture stands otherwise one of them mostly holds. Compares
/// quotients without division, as there may be nothing below.
bool HealthMonitor::is_contradicted() const {
  if (fast_.met * slow_.judged >= config_.lost_share * slow_.met * fast_.judged) return false;
  // What the map cannot judge counts as usual: where its end is near, few beams would decide.
  const double unusual = config_.lost_surface_share - (1.0 - fast_.judged);
  if (fast_.at_surface * slow_.judged >= unusual * slow_.at_surface) return false;
  if (fast_.stopped > kMaxStopped * fast_.judged) return true;
  return fast_.at_surface * (slow_.judged - slow_.stopped) <
         config_.lost_passing_share * slow_.at_surface * (fast_.judged - fast_.stopped);
}

void HealthMonitor::search_ends() {
  if (doubtful_in_a_row_ >= 0) return;
  const auto memory = static_cast<int>(std::ceil(1.0 / std::max(config_.fast_rate, 0.01)));
  doubtful_in_a_row_ = std::max(doubtful_in_a_row_, -memory);
}

double HealthMonitor::injection_share() const {
  if (!config_.inject || config_.tolerated_drop >= 1.0 || doubtful_in_a_row_ < 0) return 0.0;
  if (health_.judged_share_fast < kMinJudged) return 0.0;
  // A sure pose with which most beams are inliers is not given up for people who pass: a random
  // pose in a place that looks alike would win by chance, and the filter would jump.
  if (health_.state == HealthState::kGood) return 0.0;
  const double share = 1.0 - health_.likelihood_ratio / (1.0 - config_.tolerated_drop);
  return std::clamp(share, 0.0, config_.max_injected);
}

FreeSpace::FreeSpace(const ReflectionGrid& map) : resolution_m_(map.resolution_m()) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (is_free(map.values()[i])) cells_.push_back(map.cell(i));
  }
}

Pose2 FreeSpace::draw(RandomStream& random) const {
  const Cell cell = cells_[random.below(static_cast<std::uint32_t>(cells_.size()))];
  const double x = (cell.x + random.uniform()) * resolution_m_;
  const double y = (cell.y + random.uniform()) * resolution_m_;
  return {x, y, random.uniform(-std::numbers::pi, std::numbers::pi)};
}

}  // namespace strata::localization
