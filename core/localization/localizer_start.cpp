// SPDX-License-Identifier: Apache-2.0
// How a localizer begins: at a pose, or anywhere, with a likelihood that is flat at first.
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/base/error.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/roughening.hpp"

namespace strata::localization {
namespace {

/// A square root of a covariance that may be singular.
Eigen::Matrix3d square_root(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

void Localizer::start(std::size_t count) {
  // Steps of different starts must not share random numbers.
  step_ = ++start_count_ << 32U;
  is_started_ = true;
  run_.reset();
  odometry_.reset();
  beyond_.reset();
  at_reading_.reset();
  is_missing_ = is_untold_ = is_patched_ = false;
  last_weighed_.reset();
  moved_ = Pose2{};
  scans_since_weighed_ = 0;
  turns_ = {};
  companions_.clear();
  must_weigh_ = false;
  are_beliefs_pooled_ = false;
  monitor_.reset();
  is_seeking_ = false;
  is_scattered_ = false;
  places_.clear();
  finder_.forget_scans();
  confirmation_.tell();
  recall_scout();
  watch_.forget();
  score_.reset();
  particles_ = ParticleSet{};
  particles_.resize(count);
  if (const PatchStates* states = model_->patch_states()) {
    states->prepare(particles_);
    resampled_ = particles_;
  } else {
    resampled_ = ParticleSet{};
  }
  set_uniform_weights(particles_);
}

void Localizer::initialize(const Pose2Gaussian& map_from_robot) {
  if (!is_finite(map_from_robot.mean) || !map_from_robot.covariance.allFinite()) {
    throw InputError("start pose", "has a number that is not finite",
                     "give a mean and a covariance of finite numbers");
  }
  start(static_cast<std::size_t>(config_.particles));
  max_particles_ =
      static_cast<std::size_t>(config_.adaptive ? config_.kld.max_particles : config_.particles);
  annealed_updates_ = config_.global_start.annealing_updates;
  const Eigen::Matrix3d root = square_root(map_from_robot.covariance);
  const PatchStates* states = model_->patch_states();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    RandomStream random(seed_, StreamId::kInitialize, step_, static_cast<std::uint32_t>(i));
    Eigen::Vector3d normal;
    for (int axis = 0; axis < 3; ++axis) normal(axis) = random.normal();
    const Eigen::Vector3d pose = map_from_robot.mean.vector() + root * normal;
    particles_.set_pose(i, {pose.x(), pose.y(), pose.z()});
    if (states != nullptr) states->draw(particles_, i, random);
  }
}

void Localizer::set_free_space(const ReflectionGrid& map) {
  free_space_ = FreeSpace(map);
  if (!config_.global_search.is_used) return;
  finder_.set_map(map);
  if (scout_ != nullptr) scout_->finder_.share_map(finder_);
}

void Localizer::initialize_global(const ReflectionGrid& map) {
  set_free_space(map);
  initialize_global();
}

void Localizer::initialize_global() {
  if (free_space_.empty()) {
    throw InputError("map", "has no free cell to start from", "use a map that was learned");
  }
  max_particles_ = global_count();
  start(max_particles_);
  annealed_updates_ = 0;
  fill(particles_, 0, StreamId::kInitialize);
  is_scattered_ = !config_.global_search.is_used;
  if (config_.global_search.is_used) seek(false);
}

void Localizer::seek(bool keeps_old) {
  is_seeking_ = true;
  keeps_old_ = keeps_old;
  sought_ = 0;
  places_.clear();
  confirmation_.search();
}

/// Looks for what was seen last in the whole map.
void Localizer::find_places() {
  const std::vector<PlaceSeed> seeds = finder_.find(sought_++);
  if (seeds.empty()) return;
  places_.begin(seeds, keeps_old_, model_->patch_states(), seed_, step_, particles_);
  annealed_updates_ = config_.global_start.annealing_updates;
  is_seeking_ = false;
}

/// After the weights: the likeliest place, and the only one once it has refuted all others.
Pose2Gaussian Localizer::judge_places() {
  const bool is_decided = places_.judge(particles_);
  if (!is_decided) return places_.leading(particles_);
  const auto count = static_cast<std::size_t>(config_.particles);
  const double offset = RandomStream(seed_, StreamId::kRecovery, step_).uniform();
  places_.decide(count, offset, particles_, resampled_);
  max_particles_ = config_.adaptive ? static_cast<std::size_t>(config_.kld.max_particles) : count;
  return estimate(particles_);
}

Pose2Gaussian Localizer::pose_now() {
  if (!places_.is_active()) return estimate(particles_);
  (void)places_.judge(particles_);  // where they are now; no weight has changed
  return places_.leading(particles_);
}

std::size_t Localizer::global_count() const {
  const auto wanted = static_cast<std::size_t>(
      std::ceil(config_.global_start.particles_per_m2 * free_space_.area_m2()));
  return std::max<std::size_t>(
      static_cast<std::size_t>(config_.particles),
      std::min(wanted, static_cast<std::size_t>(config_.global_start.max_particles)));
}

void Localizer::fill(ParticleSet& particles, std::size_t begin, StreamId stream) const {
  const PatchStates* states = model_->patch_states();
  for (std::size_t i = begin; i < particles.size(); ++i) {
    RandomStream random(seed_, stream, step_, static_cast<std::uint32_t>(i));
    particles.set_pose(i, free_space_.draw(random));
    if (states != nullptr) states->draw(particles, i, random);
  }
}

void Localizer::redraw(std::size_t keep, std::size_t added, double offset) {
  draw_low_variance(particles_.weight, keep, offset, drawn_);
  resampled_.belief_columns = particles_.belief_columns;
  resampled_.resize(keep + added);
  resampled_.share(particles_);
  for (std::size_t j = 0; j < keep; ++j) resampled_.copy_from(particles_, drawn_[j], j);
  fill(resampled_, keep, StreamId::kRecovery);
  std::swap(particles_, resampled_);
}

void Localizer::search_everywhere() {
  if (config_.global_search.is_used) {
    monitor_.search_begins(config_.global_start.annealing_updates);
    if (!is_open()) {
      finder_.forget_scans();  // the robot may have been carried away since
      seek(true);
    }
    return;
  }
  const auto keep = static_cast<std::size_t>(config_.particles);
  const std::size_t added = global_count();
  redraw(keep, added, RandomStream(seed_, StreamId::kResample, step_).uniform());
  for (std::size_t j = 0; j < particles_.size(); ++j) {
    particles_.weight[j] = 0.5 / static_cast<double>(j < keep ? keep : added);
  }
  max_particles_ = particles_.size();
  annealed_updates_ = 0;
  monitor_.search_begins(config_.global_start.annealing_updates);
}

double Localizer::annealing() const {
  if (places_.is_active()) return config_.global_search.places.tempering;
  const int updates = config_.global_start.annealing_updates;
  if (annealed_updates_ >= updates) return 1.0;
  // Factor, its root, 1: docs/theory/patch_localization.md, "Global start".
  const int step = 3 * annealed_updates_ / updates;
  return std::pow(config_.global_start.annealing_factor, 0.5 * (2 - step));
}

void Localizer::roughen_start() {
  // Longer than half of the way it would blur a pose that was found by one mark and then sees none.
  const int updates = (config_.global_start.annealing_updates + 1) / 2;
  if (annealed_updates_ >= updates || config_.global_start.roughening <= 0.0) return;
  const double left = 1.0 - static_cast<double>(annealed_updates_) / updates;
  const double spacing = pose_spacing(free_space_.area_m2(), max_particles_);
  roughen(config_.global_start.roughening * spacing * left, seed_, step_, particles_, *pool_);
}

std::size_t Localizer::min_while_annealing() const {
  // The bins of KLD sampling say how many particles describe the posterior as it is, but while it
  // is still flattened the place that will win may hold few of them: go down evenly instead.
  const int updates = config_.global_start.annealing_updates;
  if (annealed_updates_ >= updates) return 0;
  return max_particles_ * static_cast<std::size_t>(updates - annealed_updates_) /
         static_cast<std::size_t>(updates);
}

}  // namespace strata::localization
