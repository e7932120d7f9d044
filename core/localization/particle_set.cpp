// SPDX-License-Identifier: Apache-2.0
#include "core/localization/particle_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"
#include "core/localization/particle_kernels.hpp"

namespace strata::localization {

void ParticleSet::resize(std::size_t count) {
  x_m.resize(count);
  y_m.resize(count);
  theta_rad.resize(count);
  weight.resize(count);
  submap.resize(count, -1);
  configuration.resize(count, -1);
  beliefs.resize(count * belief_columns);
}

void ParticleSet::set_pose(std::size_t i, const Pose2& pose) {
  x_m[i] = pose.x;
  y_m[i] = pose.y;
  theta_rad[i] = wrap_angle(pose.theta);
}

void ParticleSet::copy_from(const ParticleSet& other, std::size_t from, std::size_t to) {
  x_m[to] = other.x_m[from];
  y_m[to] = other.y_m[from];
  theta_rad[to] = other.theta_rad[from];
  weight[to] = other.weight[from];
  submap[to] = other.submap[from];
  configuration[to] = other.configuration[from];
  if (belief_columns > 0) {
    const std::span<const float> row = other.belief(from);
    std::copy(row.begin(), row.end(), belief(to).begin());
  }
}

void ParticleSet::share(const ParticleSet& other) {
  shared_belief = other.shared_belief;
  time = other.time;
  usual = other.usual;
}

double effective_sample_size(const ParticleSet& particles) {
  const double squares = sum_of_squares(particles.weight.data(), particles.size());
  return squares > 0.0 ? 1.0 / squares : 0.0;
}

void set_uniform_weights(ParticleSet& particles) {
  std::fill(particles.weight.begin(), particles.weight.end(),
            1.0 / static_cast<double>(std::max<std::size_t>(1, particles.size())));
}

double reweigh(ParticleSet& particles, std::span<const double> log_likelihood) {
  double* const weight = particles.weight.data();
  const double greatest = greatest_log(weight, log_likelihood.data(), particles.size());
  if (!std::isfinite(greatest)) return -std::numeric_limits<double>::infinity();
  const double sum = multiply_weights(log_likelihood.data(), greatest, weight, particles.size());
  for (double& w : particles.weight) w /= sum;
  return greatest + std::log(sum);
}

Pose2Gaussian estimate(const ParticleSet& particles) {
  const WeighedPoses poses{particles.x_m.data(), particles.y_m.data(), particles.theta_rad.data(),
                           particles.weight.data(), particles.size()};
  const PoseSums sums = sum_poses(poses);
  Pose2Gaussian result;
  if (sums.weight <= 0.0) return result;
  result.mean = {sums.x / sums.weight, sums.y / sums.weight, std::atan2(sums.sine, sums.cosine)};
  const SpreadSums spread = sum_spread(poses, result.mean);
  result.covariance << spread.xx, spread.xy, spread.xt,  //
      spread.xy, spread.yy, spread.yt,                   //
      spread.xt, spread.yt, spread.tt;
  result.covariance /= sums.weight;
  return result;
}

double weighted_error(const ParticleSet& particles, const Pose2& truth) {
  double error = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    error +=
        particles.weight[i] * std::hypot(particles.x_m[i] - truth.x, particles.y_m[i] - truth.y);
  }
  return error;
}

double weighted_heading_error(const ParticleSet& particles, const Pose2& truth) {
  double error = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    error += particles.weight[i] * std::abs(angle_difference(particles.theta_rad[i], truth.theta));
  }
  return error;
}

}  // namespace strata::localization
