// SPDX-License-Identifier: Apache-2.0
#include "core/localization/particle_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"

namespace strata::localization {

void ParticleSet::resize(std::size_t count) {
  x_m.resize(count);
  y_m.resize(count);
  theta_rad.resize(count);
  weight.resize(count);
  submap.resize(count, -1);
  patch.resize(count, -1);
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
  patch[to] = other.patch[from];
  if (belief_columns > 0) {
    const std::span<const float> row = other.belief(from);
    std::copy(row.begin(), row.end(), belief(to).begin());
  }
}

double effective_sample_size(const ParticleSet& particles) {
  double squares = 0.0;
  for (const double w : particles.weight) squares += w * w;
  return squares > 0.0 ? 1.0 / squares : 0.0;
}

void set_uniform_weights(ParticleSet& particles) {
  std::fill(particles.weight.begin(), particles.weight.end(),
            1.0 / static_cast<double>(std::max<std::size_t>(1, particles.size())));
}

double reweigh(ParticleSet& particles, std::span<const double> log_likelihood) {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  double largest = kNever;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (particles.weight[i] > 0.0) largest = std::max(largest, log_likelihood[i]);
  }
  if (!std::isfinite(largest)) return kNever;
  double sum = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double factor = std::exp(log_likelihood[i] - largest);
    particles.weight[i] = std::isfinite(factor) ? particles.weight[i] * factor : 0.0;
    sum += particles.weight[i];
  }
  for (double& w : particles.weight) w /= sum;
  return largest + std::log(sum);
}

Pose2Gaussian estimate(const ParticleSet& particles) {
  double sum = 0.0;
  double x = 0.0;
  double y = 0.0;
  double c = 0.0;
  double s = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double w = particles.weight[i];
    sum += w;
    x += w * particles.x_m[i];
    y += w * particles.y_m[i];
    c += w * std::cos(particles.theta_rad[i]);
    s += w * std::sin(particles.theta_rad[i]);
  }
  Pose2Gaussian result;
  if (sum <= 0.0) return result;
  result.mean = {x / sum, y / sum, std::atan2(s, c)};
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Eigen::Vector3d d(particles.x_m[i] - result.mean.x, particles.y_m[i] - result.mean.y,
                            angle_difference(particles.theta_rad[i], result.mean.theta));
    result.covariance += (particles.weight[i] / sum) * d * d.transpose();
  }
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
