// SPDX-License-Identifier: Apache-2.0
#include "core/localization/place_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.hpp"
#include "core/localization/patch_states.hpp"
#include "core/localization/resampling.hpp"
#include "core/random/stream.hpp"

namespace strata::localization {
namespace {

/// Particles about the seed itself, where the search says that the scan fits best.
constexpr double kTight_m = 0.05;
constexpr double kTight_rad = 0.02;
/// Places nearer than this share of the separation have met.
constexpr double kMetShare = 0.2;
/// Of a place's particles, when fewer than this share have its weight they are drawn anew.
constexpr double kResampleBelow = 0.5;

Pose2 drawn(const PlaceSeed& seed, bool is_tight, RandomStream& random) {
  Pose2 pose = seed.map_from_robot;
  if (is_tight) {
    pose.x += kTight_m * random.normal();
    pose.y += kTight_m * random.normal();
    pose.theta += kTight_rad * random.normal();
  } else {
    pose.x += random.uniform(-seed.half_m, seed.half_m);
    pose.y += random.uniform(-seed.half_m, seed.half_m);
    pose.theta += random.uniform(-seed.half_rad, seed.half_rad);
  }
  return pose;
}

}  // namespace

void PlaceHypotheses::begin(std::span<const PlaceSeed> seeds, bool keeps_old,
                            const PatchStates* states, std::uint64_t seed, std::uint64_t step,
                            ParticleSet& particles) {
  const std::size_t old = keeps_old ? particles.size() : 0;
  const auto each = static_cast<std::size_t>(config_.particles);
  const ParticleSet before = particles;
  particles = ParticleSet{};
  particles.resize(old + seeds.size() * each);
  if (states != nullptr) states->prepare(particles);
  particles.share(before);
  places_.assign(seeds.size() + (keeps_old ? 1 : 0), {});
  place_of_.assign(particles.size(), 0);
  for (std::size_t i = 0; i < old; ++i) {
    particles.copy_from(before, i, i);
    particles.weight[i] *= seeds.empty() ? 1.0 : 0.5;
  }
  const double weight =
      (keeps_old ? 0.5 : 1.0) / static_cast<double>(std::max<std::size_t>(seeds.size() * each, 1));
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    for (std::size_t j = 0; j < each; ++j) {
      const std::size_t i = old + s * each + j;
      RandomStream random(seed, StreamId::kInitialize, step, static_cast<std::uint32_t>(i));
      particles.set_pose(i, drawn(seeds[s], 2 * j < each, random));
      if (states != nullptr) states->draw(particles, i, random);
      particles.weight[i] = weight;
      place_of_[i] = static_cast<std::uint32_t>(s + (keeps_old ? 1 : 0));
    }
  }
}

void PlaceHypotheses::resample(std::uint64_t seed, std::uint64_t step, ParticleSet& particles,
                               ParticleSet& spare) {
  std::vector<std::vector<std::uint32_t>> members(places_.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (!places_[place_of_[i]].is_refuted) {
      members[place_of_[i]].push_back(static_cast<std::uint32_t>(i));
    }
  }
  const auto most = static_cast<std::size_t>(config_.particles);
  std::vector<std::uint32_t> kept;
  std::vector<double> weights;
  std::vector<std::uint32_t> places;
  std::vector<Place> alive;
  std::vector<double> own;
  std::vector<std::uint32_t> drawn_own;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const std::vector<std::uint32_t>& of = members[p];
    double mass = 0.0;
    double squares = 0.0;
    own.clear();
    for (const std::uint32_t i : of) {
      own.push_back(particles.weight[i]);
      mass += own.back();
      squares += own.back() * own.back();
    }
    if (!(mass > 0.0)) continue;
    const double effective = mass * mass / squares;
    const bool is_drawn =
        effective < kResampleBelow * static_cast<double>(of.size()) || of.size() > most;
    const std::size_t count = is_drawn ? std::min(most, of.size()) : of.size();
    if (is_drawn) {
      const double offset =
          RandomStream(seed, StreamId::kResample, step, static_cast<std::uint32_t>(p)).uniform();
      draw_low_variance(own, count, offset, drawn_own);
    }
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t from = is_drawn ? drawn_own[j] : j;
      kept.push_back(of[from]);
      weights.push_back(is_drawn ? mass / static_cast<double>(count) : own[from]);
      places.push_back(static_cast<std::uint32_t>(alive.size()));
    }
    if (p == best_) best_ = alive.size();
    alive.push_back(places_[p]);
  }
  spare.belief_columns = particles.belief_columns;
  spare.resize(kept.size());
  spare.share(particles);
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  for (std::size_t j = 0; j < kept.size(); ++j) {
    spare.copy_from(particles, kept[j], j);
    spare.weight[j] = weights[j] / sum;
  }
  std::swap(particles, spare);
  places_ = std::move(alive);
  place_of_ = std::move(places);
}

bool PlaceHypotheses::are_near(const Pose2& a, const Pose2& b, double share) const {
  return translation_distance(a, b) <= share * config_.separation_m &&
         std::abs(wrap_angle(a.theta - b.theta)) <= share * config_.separation_rad;
}

/// Masses and means.
void PlaceHypotheses::gather(const ParticleSet& particles) {
  struct Sums {
    double mass = 0.0, x = 0.0, y = 0.0, c = 0.0, s = 0.0;
  };
  std::vector<Sums> sums(places_.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Sums& sum = sums[place_of_[i]];
    const double weight = particles.weight[i];
    sum.mass += weight;
    sum.x += weight * particles.x_m[i];
    sum.y += weight * particles.y_m[i];
    sum.c += weight * std::cos(particles.theta_rad[i]);
    sum.s += weight * std::sin(particles.theta_rad[i]);
  }
  best_ = 0;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    Place& place = places_[p];
    const Sums& sum = sums[p];
    place.mass = sum.mass;
    if (sum.mass > 0.0) place.mean = {sum.x / sum.mass, sum.y / sum.mass, std::atan2(sum.s, sum.c)};
    if (place.mass > places_[best_].mass) best_ = p;
  }
}

/// Particles of places that have met are one place's.
void PlaceHypotheses::merge() {
  std::vector<std::uint32_t> into(places_.size());
  for (std::size_t p = 0; p < places_.size(); ++p) {
    into[p] = static_cast<std::uint32_t>(p);
    if (places_[p].is_refuted) continue;
    for (std::size_t q = 0; q < p; ++q) {
      if (into[q] != q || places_[q].is_refuted) continue;
      if (!are_near(places_[p].mean, places_[q].mean, kMetShare)) continue;
      into[p] = static_cast<std::uint32_t>(q);
      break;
    }
  }
  for (std::uint32_t& place : place_of_) place = into[place];
}

bool PlaceHypotheses::judge(const ParticleSet& particles) {
  gather(particles);
  merge();
  gather(particles);
  const double best = places_[best_].mass;
  bool is_decided = true;
  beliefs_.clear();
  for (Place& place : places_) {
    place.is_refuted = !(place.mass > best * std::exp(-config_.refuted_nats));
    if (place.is_refuted) continue;
    beliefs_.push_back({place.mean, place.mass});
    if (place.mass > best * std::exp(-config_.decided_nats) &&
        !are_near(place.mean, places_[best_].mean)) {
      is_decided = false;
    }
  }
  std::stable_sort(
      beliefs_.begin(), beliefs_.end(),
      [](const PlaceBelief& a, const PlaceBelief& b) { return a.probability > b.probability; });
  return is_decided;
}

Pose2Gaussian PlaceHypotheses::leading(const ParticleSet& particles) const {
  Pose2Gaussian pose;
  pose.mean = places_[best_].mean;
  pose.covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Eigen::Vector3d away(particles.x_m[i] - pose.mean.x, particles.y_m[i] - pose.mean.y,
                               wrap_angle(particles.theta_rad[i] - pose.mean.theta));
    pose.covariance += particles.weight[i] * away * away.transpose();
  }
  return pose;
}

void PlaceHypotheses::decide(std::size_t count, double offset, ParticleSet& particles,
                             ParticleSet& spare) {
  std::vector<double> weights(particles.size(), 0.0);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Place& place = places_[place_of_[i]];
    if (are_near(place.mean, places_[best_].mean)) weights[i] = particles.weight[i];
  }
  std::vector<std::uint32_t> kept;
  draw_low_variance(weights, count, offset, kept);
  spare.belief_columns = particles.belief_columns;
  spare.resize(count);
  spare.share(particles);
  for (std::size_t j = 0; j < count; ++j) spare.copy_from(particles, kept[j], j);
  std::swap(particles, spare);
  set_uniform_weights(particles);
  clear();
}

}  // namespace strata::localization
