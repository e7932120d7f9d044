// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/known_pose_predictor.hpp"

#include <algorithm>
#include <utility>

#include "core/localization/resampling.hpp"
#include "core/random/stream.hpp"

namespace strata::pipeline {
namespace {

using localization::ParticleSet;
using localization::PatchMemory;

constexpr std::uint64_t kSeed = 1;
/// Draws of a model that samples configurations; beliefs are exact and need no second particle.
constexpr std::size_t kDraws = 100;

}  // namespace

KnownPosePredictor::KnownPosePredictor(const maps::MapModel& model)
    : model_(model), states_(model.sensor->patch_states()) {
  const bool is_sampled = states_ != nullptr && states_->memory() == PatchMemory::kNone;
  particles_.resize(is_sampled ? kDraws : 1);
  localization::set_uniform_weights(particles_);
  if (states_ == nullptr) return;
  states_->prepare(particles_);
  RandomStream random(kSeed, StreamId::kPatchTransition);
  for (std::size_t i = 0; i < particles_.size(); ++i) states_->draw(particles_, i, random);
}

void KnownPosePredictor::go_to(const Pose2& map_from_robot, Stamp stamp) {
  for (std::size_t i = 0; i < particles_.size(); ++i) particles_.set_pose(i, map_from_robot);
  ++step_;
  if (states_ != nullptr) {
    const double dt_s = last_ ? std::max(0.0, (stamp - *last_).seconds()) : 0.0;
    states_->tell_time(stamp, particles_);
    states_->predict(dt_s, kSeed, step_, particles_, pool_);
  }
  last_ = stamp;
}

maps::RangeFunction KnownPosePredictor::expected_range() const {
  return model_.best_prediction(particles_);
}

KnownPosePredictor::Likelihood KnownPosePredictor::likelihood(const Scan& scan) const {
  ParticleSet copy = particles_;  // a sensor model may update the beliefs that particles carry
  std::vector<double> values(copy.size());
  Likelihood result;
  result.beams = model_.sensor->log_likelihoods(scan, {1.0}, copy, values, pool_);
  result.nats = localization::reweigh(copy, values);
  return result;
}

void KnownPosePredictor::learn(const Scan& scan) {
  if (states_ == nullptr) return;
  std::vector<double> values(particles_.size());
  model_.sensor->log_likelihoods(scan, {model_.sensor->tempering()}, particles_, values, pool_);
  localization::reweigh(particles_, values);
  states_->absorb(localization::estimate(particles_), particles_);
  const auto n = static_cast<double>(particles_.size());
  if (localization::effective_sample_size(particles_) < 0.5 * n) resample();
}

void KnownPosePredictor::resample() {
  std::vector<std::uint32_t> drawn;
  RandomStream random(kSeed, StreamId::kResample, step_);
  localization::draw_low_variance(particles_.weight, particles_.size(), random.uniform(), drawn);
  ParticleSet resampled = particles_;
  for (std::size_t j = 0; j < drawn.size(); ++j) resampled.copy_from(particles_, drawn[j], j);
  localization::set_uniform_weights(resampled);
  particles_ = std::move(resampled);
}

std::vector<localization::SubmapBelief> KnownPosePredictor::beliefs() const {
  if (states_ == nullptr) return {};
  return states_->posterior(particles_);
}

}  // namespace strata::pipeline
