// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/localization/pose_spread.hpp"
#include "core/rays/scan_beams.hpp"

namespace strata::localization {
namespace {

const SensorModel& existing(const std::shared_ptr<const SensorModel>& model) {
  if (model == nullptr) throw std::invalid_argument("Localizer: the sensor model is null");
  return *model;
}

}  // namespace

Localizer::Localizer(const LocalizerConfig& config, std::shared_ptr<const SensorModel> model,
                     std::uint64_t seed, int threads)
    : config_(config),
      own_model_(existing(model).for_one_run()),
      model_(own_model_ != nullptr ? own_model_ : std::move(model)),
      seed_(seed),
      pool_(std::make_shared<WorkerPool>(threads)),
      monitor_(config.recovery),
      finder_(config.global_search),
      places_(config.global_search.places),
      confirmation_(config.global_search.confirmation),
      watch_(config.global_search.watch),
      odometry_(config.gating.limits()),
      beyond_(config.beyond_map) {
  require_valid(config, "localizer");
}

void Localizer::set_model(std::shared_ptr<const SensorModel> model) {
  std::shared_ptr<SensorModel> own = existing(model).for_one_run();
  if (own != nullptr) own->adopt(*model_);
  const std::shared_ptr<const SensorModel> before =
      std::exchange(model_, own != nullptr ? own : std::move(model));
  own_model_ = std::move(own);
  if (!is_started_) return;
  adopt_particles(*before);
  if (scout_ == nullptr) return;
  scout_->model_ = model_;
  scout_->adopt_particles(*before);
}

/// What particles knew by the model before becomes what they know by the one that is there now.
void Localizer::adopt_particles(const SensorModel& before) {
  if (const PatchStates* states = model_->patch_states()) {
    // A step of its own, so that its draws are not those of the next scan's transition.
    states->adopt(before.patch_states(), seed_, ++step_, particles_);
  } else {
    particles_.belief_columns = 0;
    particles_.beliefs.clear();
    particles_.shared_belief.clear();
    particles_.usual.clear();
    std::fill(particles_.submap.begin(), particles_.submap.end(), -1);
    std::fill(particles_.configuration.begin(), particles_.configuration.end(), -1);
    result_.submaps.clear();
  }
  are_beliefs_pooled_ = false;
  resampled_ = particles_;
}

Pose2 Localizer::motion_since_last(const Observation& observation) {
  using Kind = OdometryStep::Kind;
  if (run_ != observation.run) {
    run_ = observation.run;
    odometry_.reset();
    beyond_.reset();
    is_patched_ = false;
  }
  const OdometryStep step = odometry_.pass(
      observation.scan.stamp, observation.has_odometry ? &observation.odom_from_robot : nullptr);
  is_missing_ = step.kind == Kind::kMissing;
  is_untold_ |= step.kind == Kind::kUntold || step.kind == Kind::kJumped;
  if (step.kind == Kind::kJumped) {
    ++odometry_jumps_;
    companions_.clear();
  }
  if (!is_missing_) is_untold_ |= std::exchange(is_patched_, false);
  return beyond_.follow(observation).value_or(step.motion);
}

/// Before a scan is weighed: what odometry said since the last one that was, with its noise.
void Localizer::follow_motion(const Pose2& moved_before) {
  // A start has no noise of motion yet, unless the robot drove on before it saw anything.
  if (!last_weighed_ && scans_since_weighed_ <= 1) return;
  if (monitor_.wants_restart() && !free_space_.empty()) {
    search_everywhere();
  } else {
    resample();
  }
  const bool is_told = beyond_.is_told() || (!is_missing_ && !is_untold_);
  sample_motions(moved_, moved_before, is_told, beyond_.noise(config_.motion), seed_, step_,
                 particles_, *pool_);
  roughen_start();
}

/// After a scan was weighed. Without odometry the particles followed what the scans say: odometry
/// that comes back has that in its motion too, and must not add it again.
void Localizer::settle_motion(const Pose2Gaussian& pose) {
  is_untold_ = false;
  if (!is_missing_) return;
  if (at_reading_ && is_one_place(pose, config_.recovery.uncertain_stddev_m)) {
    odometry_.moved_otherwise(between(at_reading_->mean, pose.mean));
    at_reading_ = pose;
  } else {
    odometry_.forget_motion();
    at_reading_.reset();
  }
  is_patched_ = true;
}

bool Localizer::is_due() {
  const GatingConfig& gating = config_.gating;
  if (must_weigh_ || !last_weighed_ || gating.every_scans == 1) return true;
  const auto scans = static_cast<double>(turns_.alive()) * gating.every_scans;
  const bool passes = static_cast<double>(scans_since_weighed_) >= scans ||
                      has_moved(Pose2{}, moved_, gating.translation_m, gating.rotation_rad);
  return passes && turns_.has_turn();
}

const LocalizationResult& Localizer::update(const Observation& observation) {
  if (!is_started_) throw std::logic_error("Localizer::update before initialize");
  result_.relocated_m.reset();
  const Pose2 motion = motion_since_last(observation);
  const Pose2 moved_before = moved_;
  moved_ = moved_ * motion;
  ++scans_since_weighed_;
  const bool is_usable = rays::says_something(observation.scan);
  if (!is_usable) {
    ++unusable_scans_;
    score_.drive_unseen(motion.translation().norm());
  }
  if (is_usable) turns_.see(observation.scan, observation.run);
  if (is_usable && turns_.alive() > 1) companions_.keep(observation);
  const bool is_weighed = is_usable && is_due();
  if (!is_weighed) move_particles(motion, particles_, *pool_);
  const Pose2Gaussian pose = is_weighed ? weigh(observation, moved_before) : pose_now();
  if (!is_missing_) {
    at_reading_.reset();
    if (is_one_place(pose, config_.recovery.uncertain_stddev_m)) at_reading_ = pose;
  }
  return make_result(watch(observation, pose, is_weighed), is_weighed);
}

void Localizer::resample() {
  if (places_.is_active()) return places_.resample(seed_, step_, particles_, resampled_);
  const bool is_annealed = annealed_updates_ >= config_.global_start.annealing_updates;
  const double share = is_annealed && !free_space_.empty() ? monitor_.injection_share() : 0.0;
  const auto count = static_cast<double>(particles_.size());
  if (share <= 0.0 && effective_sample_size(particles_) >= config_.resample_below * count) return;

  const double offset = RandomStream(seed_, StreamId::kResample, step_).uniform();
  std::size_t keep = particles_.size();
  if (config_.adaptive) {
    draw_low_variance(particles_.weight, keep, offset, drawn_);
    const std::size_t needed =
        kld_particle_count(count_bins(particles_, drawn_, config_.kld, bins_), config_.kld.epsilon,
                           config_.kld.quantile);
    // A global start may need more than tracking; once the posterior fits, the lower limit holds.
    if (is_annealed && needed <= static_cast<std::size_t>(config_.kld.max_particles)) {
      max_particles_ = static_cast<std::size_t>(config_.kld.max_particles);
    }
    keep =
        std::clamp(needed, static_cast<std::size_t>(config_.kld.min_particles),
                   std::max(max_particles_, static_cast<std::size_t>(config_.kld.min_particles)));
    keep = std::max(keep, min_while_annealing());
  } else if (is_annealed) {
    keep = static_cast<std::size_t>(config_.particles);
  }
  std::size_t injected = 0;
  if (share > 0.0) {
    keep = std::max(keep, static_cast<std::size_t>(config_.particles));
    injected = static_cast<std::size_t>(share * static_cast<double>(keep));
    keep -= injected;
  }
  redraw(keep, injected, offset);
  set_uniform_weights(particles_);
}

bool Localizer::is_recovering() const {
  if (scout_ != nullptr || monitor_.is_searching()) return true;
  return !is_ambiguous() && !free_space_.empty() && monitor_.injection_share() > 0.0;
}

/// Of the place that is told as the pose, against the others that scans have left or a scout found.
double Localizer::place_probability(const Pose2& pose) const {
  if (is_contested()) return score_.value() / (score_.value() + scout_->score_.value());
  if (!places_.is_active() || places_.beliefs().empty()) return 1.0;
  double probability = 0.0;
  for (const PlaceBelief& place : places_.beliefs()) {
    if (places_.are_near(place.map_from_robot, pose)) probability += place.probability;
  }
  return std::min(1.0, probability);
}

void Localizer::tell_places(const Pose2& pose) {
  std::vector<PlaceBelief>& places = result_.places;
  places.clear();
  if (is_contested()) {
    const double own = place_probability(pose);
    const double others = 1.0 - own;
    for (const PlaceBelief& place : scout_->places_.beliefs()) {
      places.push_back({place.map_from_robot, others * place.probability});
    }
    if (places.empty()) places.push_back({scout_->result_.pose.mean, others});
    places.push_back({pose, own});
  } else if (places_.is_active()) {
    places = places_.beliefs();
  } else if (result_.is_ambiguous && !is_seeking_) {
    places.push_back({pose, result_.score});
  }
}

const LocalizationResult& Localizer::make_result(const Pose2Gaussian& pose, bool weighed) {
  result_.pose = pose;
  result_.health = monitor_.health();
  result_.place_score = score_.value();
  result_.score = result_.place_score * place_probability(pose.mean);
  result_.effective_sample_size = effective_sample_size(particles_);
  result_.particles = particles_.size();
  result_.weighed = weighed;
  result_.is_beyond_map = beyond_.is_outside();
  result_.is_ambiguous = is_ambiguous() || is_contested();
  result_.is_recovering = is_recovering();
  tell_places(pose.mean);
  result_.converged =
      !result_.is_ambiguous && position_stddev(result_.pose) <= config_.recovery.uncertain_stddev_m;
  if (result_.is_ambiguous && result_.health.state == HealthState::kGood) {
    result_.health.state = HealthState::kConverging;
  }
  if (!are_beliefs_pooled_) pool_beliefs();
  return result_;
}

}  // namespace strata::localization
