// SPDX-License-Identifier: Apache-2.0
#include "core/localization/place_ranking.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"
#include "core/localization/patch_states.hpp"

namespace strata::localization {
namespace {

/// The three axes, both ways.
std::array<Pose2, 6> moved(const Pose2& pose, double step_m, double step_rad) {
  std::array<Pose2, 6> poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    poses[i] = pose;
    if (i < 2) {
      poses[i].x += sign * step_m;
    } else if (i < 4) {
      poses[i].y += sign * step_m;
    } else {
      poses[i].theta = wrap_angle(pose.theta + sign * step_rad);
    }
  }
  return poses;
}

double divergence_of(double after, double before) {
  return after > 0.0 && before > 0.0 ? after * std::log(after / before) : 0.0;
}

/// KL(after | before) of one row [nats], what it leaves to something else included.
double divergence(const PatchStates& states, std::span<const float> after,
                  std::span<const float> before) {
  double sum = 0.0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    sum += divergence_of(static_cast<double>(after[i]), static_cast<double>(before[i]));
  }
  for (std::size_t s = 0; s < states.submaps() && states.expects_something_else(); ++s) {
    if (!(states.something_else(s) > 0.0F)) continue;
    const auto of_submap = [&](std::span<const float> row) {
      return left_of(row.subspan(states.offset(s), static_cast<std::size_t>(states.count(s))));
    };
    sum += divergence_of(of_submap(after), of_submap(before));
  }
  return sum;
}

}  // namespace

ParticleSet particles_at(std::span<const Pose2> poses, const SensorModel& model, Stamp time) {
  ParticleSet particles;
  particles.resize(poses.size());
  const PatchStates* states = model.patch_states();
  if (states != nullptr) {
    states->prepare(particles);
    states->tell_time(time, particles);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    particles.set_pose(i, poses[i]);
    if (states == nullptr) continue;
    RandomStream random(0, StreamId::kInitialize, 0, static_cast<std::uint32_t>(i));
    states->draw(particles, i, random);
  }
  set_uniform_weights(particles);
  return particles;
}

void weigh_places(const Scan& scan, const SensorModel& model, ParticleSet& particles,
                  std::vector<double>& log_likelihood, WorkerPool& pool) {
  log_likelihood.resize(particles.size());
  const Weighing weighing{.tempering = model.tempering(), .is_place_sure = false};
  const std::vector<float> before = particles.beliefs;
  (void)model.log_likelihoods(scan, weighing, particles, log_likelihood, pool);
  const PatchStates* states = model.patch_states();
  if (states == nullptr || states->memory() != PatchMemory::kPerParticle) return;
  ParticleSet after = particles;
  (void)model.log_likelihoods(scan, weighing, after, log_likelihood, pool);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::size_t columns = particles.belief_columns;
    log_likelihood[i] -=
        divergence(*states, particles.belief(i), {before.data() + i * columns, columns});
  }
}

std::vector<RankedPlace> rank_places(std::span<const PlaceCandidate> candidates, const Scan& scan,
                                     const SensorModel& model, const PlaceRankingConfig& config,
                                     WorkerPool& pool) {
  std::vector<Pose2> poses;
  for (const PlaceCandidate& candidate : candidates) poses.push_back(candidate.map_from_robot);
  std::vector<double> log_likelihood;
  ParticleSet particles = particles_at(poses, model, scan.stamp);
  weigh_places(scan, model, particles, log_likelihood, pool);
  std::vector<RankedPlace> places;
  for (std::size_t i = 0; i < poses.size(); ++i) places.push_back({poses[i], log_likelihood[i]});
  double step_m = config.step_m;
  double step_rad = config.step_rad;
  for (int round = 0; round < config.rounds && !places.empty(); ++round) {
    double best = -std::numeric_limits<double>::infinity();
    for (const RankedPlace& place : places) best = std::max(best, place.log_likelihood);
    poses.clear();
    std::vector<std::size_t> owners;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!(places[i].log_likelihood >= best - config.hopeless_nats)) continue;
      for (const Pose2& pose : moved(places[i].map_from_robot, step_m, step_rad)) {
        poses.push_back(pose);
        owners.push_back(i);
      }
    }
    particles = particles_at(poses, model, scan.stamp);
    weigh_places(scan, model, particles, log_likelihood, pool);
    for (std::size_t j = 0; j < poses.size(); ++j) {
      RankedPlace& place = places[owners[j]];
      if (log_likelihood[j] > place.log_likelihood) place = {poses[j], log_likelihood[j]};
    }
    if (round % 2 == 1) {
      step_m *= 0.5;
      step_rad *= 0.5;
    }
  }
  std::stable_sort(places.begin(), places.end(), [](const RankedPlace& a, const RankedPlace& b) {
    return a.log_likelihood > b.log_likelihood;
  });
  return places;
}

double margin_of(std::span<const RankedPlace> places, double distance_m, double turn_rad) {
  if (places.empty()) return 0.0;
  const Pose2& first = places.front().map_from_robot;
  for (const RankedPlace& place : places) {
    const Pose2& other = place.map_from_robot;
    if (translation_distance(first, other) <= distance_m &&
        std::abs(wrap_angle(first.theta - other.theta)) <= turn_rad) {
      continue;
    }
    return places.front().log_likelihood - place.log_likelihood;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace strata::localization
