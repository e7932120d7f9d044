// SPDX-License-Identifier: Apache-2.0
// The search beside a pose that is doubted: a second filter, whose place takes over when it has
// shown itself better.
#include <algorithm>
#include <vector>

#include "core/base/state_archive.hpp"
#include "core/localization/localizer.hpp"

namespace strata::localization {
namespace {

/// Far from the draws of the filter itself.
constexpr std::uint64_t kScoutSeed = 0x9e3779b97f4a7c15U;

LocalizerConfig scout_config(LocalizerConfig config) {
  config.global_search.watch.is_used = false;
  config.recovery.inject = false;
  config.recovery.restart_after = 0;
  return config;
}

}  // namespace

Localizer::Localizer(const Localizer& beside, std::uint64_t seed)
    : config_(scout_config(beside.config_)),
      model_(beside.model_),
      seed_(seed),
      pool_(beside.pool_),
      monitor_(config_.recovery),
      finder_(beside.finder_),
      places_(config_.global_search.places),
      confirmation_(config_.global_search.confirmation),
      watch_(config_.global_search.watch),
      odometry_(config_.gating.limits()),
      beyond_(config_.beyond_map) {}

/// It looks for the scans of which the pose was doubted, this one the last.
void Localizer::send_scout(const Observation& observation) {
  scout_.reset(new Localizer(*this, seed_ + kScoutSeed * (step_ + 1)));
  scout_->start(1);  // places bring their own
  scout_->finder_ = finder_;
  scout_->annealed_updates_ = config_.global_start.annealing_updates;
  scout_->seek(false);
  (void)scout_->update(observation);
}

void Localizer::recall_scout() {
  const bool was_believed = watch_.was_believed();
  scout_.reset();
  watch_.forget();
  if (was_believed) watch_.believe();
  contested_scans_ = 0;
}

/// Several places are left, and the pose is none of them: with the likeliest as sure as a place
/// that is confirmed, it is wrong whichever of them is right.
bool Localizer::is_refuted_by_scout(const Pose2& pose) const {
  const PlaceFinderConfig& search = config_.global_search;
  if (contested_scans_ < search.watch.doubted_scans || !scout_->places_.is_active()) return false;
  if (scout_->score_.value() < search.confirmation.confirmed_score) return false;
  const std::vector<PlaceBelief>& places = scout_->places_.beliefs();
  return std::none_of(places.begin(), places.end(), [&](const PlaceBelief& place) {
    return places_.are_near(place.map_from_robot, pose);
  });
}

/// After a scan: the scout sees it too, and its place is the robot's from now on, or not. pose: as
/// the filter itself has it; the result is the one to tell.
Pose2Gaussian Localizer::watch(const Observation& observation, const Pose2Gaussian& pose,
                               bool weighed) {
  if (scout_ != nullptr) (void)scout_->update(observation);
  if (!weighed) return pose;
  if (is_ambiguous() || !finder_.has_map()) {
    recall_scout();
    return pose;
  }
  // Where the map ends the score falls by itself, and the least wrong place of the map may fit an
  // unknown room for a while. A start that scans in the map contradicted from the beginning leads
  // out of it because it is wrong.
  const bool is_refuted_start =
      !watch_.was_believed() && (watch_.is_searching() || watch_.is_doubting());
  if (beyond_.is_outside() && !is_refuted_start) {
    recall_scout();
    return pose;
  }
  switch (watch_.judge(score_.value())) {
    case PlaceWatch::Step::kBegin:
      send_scout(observation);
      break;
    case PlaceWatch::Step::kEnd:
      scout_.reset();
      break;
    case PlaceWatch::Step::kNone:
      break;
  }
  const double doubted = config_.global_search.watch.doubted_score;
  const bool has_found = scout_ != nullptr && !scout_->is_seeking_ && score_.value() < doubted;
  const bool is_contested = has_found && scout_->score_.value() >= doubted &&
                            !places_.are_near(scout_->result_.pose.mean, pose.mean);
  contested_scans_ = is_contested ? contested_scans_ + 1 : 0;
  if (!has_found || (scout_->is_ambiguous() && !is_refuted_by_scout(pose.mean))) return pose;
  take_over();
  const Pose2Gaussian found = pose_now();
  result_.relocated_m = translation_distance(found.mean, pose.mean);
  return found;
}

/// As if the scout had been the filter all the time.
void Localizer::take_over() {
  const std::unique_ptr<Localizer> scout = std::move(scout_);
  const std::size_t unusable = unusable_scans_;
  const std::size_t jumps = odometry_jumps_;
  const std::uint64_t starts = start_count_ + 1;
  StateWriter written;
  scout->write_filter(written);
  const std::vector<std::uint8_t> bytes = written.take();
  StateReader archive(bytes, "the filter beside");
  read_filter(archive);
  unusable_scans_ = unusable;
  odometry_jumps_ = jumps;
  start_count_ = starts;
  step_ = starts << 32U;
  recall_scout();
}

}  // namespace strata::localization
