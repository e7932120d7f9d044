// SPDX-License-Identifier: Apache-2.0
#include "core/topology/cloud_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "core/geometry/angle.hpp"

namespace strata::topology {
namespace {

constexpr std::size_t kMinPoints = 10;
/// Of the gate, from one round to the next.
constexpr double kGateShrink = 0.8;
/// Points that try the starts, about.
constexpr std::size_t kSamplePoints = 80;
/// Alignments found from the starts that all points are spent on.
constexpr std::size_t kFinalists = 2;
/// Two alignments within this are one.
constexpr double kSameM = 0.05;
constexpr double kSameRad = 0.02;

struct Normal {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  // sum of w J' J
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();  // sum of w J' r
  std::size_t matched = 0;
};

/// Normal equations of sum w (n' (T p - q))^2, Cauchy weights, at T = a_from_b.
Normal normal_equations(const PlaceSurface& surface, const LocalCloud& b, const Pose2& a_from_b,
                        double gate_m, double robust_scale_m) {
  Normal normal;
  const LocalCloud& a = surface.cloud();
  const double cosine = std::cos(a_from_b.theta);
  const double sine = std::sin(a_from_b.theta);
  for (const Eigen::Vector2d& point : b.points_m) {
    const Eigen::Vector2d turned(cosine * point.x() - sine * point.y(),
                                 sine * point.x() + cosine * point.y());
    const Eigen::Vector2d at = turned + a_from_b.translation();
    const std::size_t i = surface.find_about(at, gate_m);
    if (i == NearestPoint::kNone) continue;
    const Eigen::Vector2d& n = a.normals[i];
    const double residual = n.dot(at - a.points_m[i]);
    const double scaled = residual / robust_scale_m;
    const double weight = 1.0 / (1.0 + scaled * scaled);
    const Eigen::Vector3d jacobian(n.x(), n.y(), -n.x() * turned.y() + n.y() * turned.x());
    normal.matrix += weight * jacobian * jacobian.transpose();
    normal.vector += weight * residual * jacobian;
    ++normal.matched;
  }
  return normal;
}

Pose2 refine(const PlaceSurface& a, const LocalCloud& b, const Pose2& start, double first_gate_m,
             const CloudMatchConfig& config) {
  Pose2 pose = start;
  double gate_m = first_gate_m;
  for (int i = 0; i < config.max_iterations; ++i) {
    const Normal normal = normal_equations(a, b, pose, gate_m, config.robust_scale_m);
    if (normal.matched < kMinPoints) return pose;
    // A direction that no surface fixes must not run away.
    const Eigen::Matrix3d damped =
        normal.matrix + 1e-3 * static_cast<double>(normal.matched) * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d step = damped.ldlt().solve(-normal.vector);
    pose = {pose.x + step.x(), pose.y + step.y(), wrap_angle(pose.theta + step.z())};
    const bool at_last_gate = gate_m <= config.last_gate_m;
    if (at_last_gate && step.norm() < 1e-4) break;
    gate_m = std::max(config.last_gate_m, kGateShrink * gate_m);
  }
  return pose;
}

/// About `count` points, evenly taken.
LocalCloud sample_of(const LocalCloud& cloud, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, cloud.size() / count);
  LocalCloud sample;
  for (std::size_t i = 0; i < cloud.size(); i += stride) {
    sample.points_m.push_back(cloud.points_m[i]);
    sample.normals.push_back(cloud.normals[i]);
  }
  return sample;
}

bool is_about(const Pose2& a, const Pose2& b) {
  return translation_distance(a, b) < kSameM &&
         std::abs(angle_difference(a.theta, b.theta)) < kSameRad;
}

/// Gain, overlap and information at an alignment.
PlaceMatch judge(const PlaceSurface& surface, const LocalCloud& b, const Pose2& pose,
                 const CloudMatchConfig& config) {
  const LocalCloud& a = surface.cloud();
  PlaceMatch match;
  match.a_from_b = pose;
  const double tempering = std::min(1.0, config.effective_points / static_cast<double>(b.size()));
  const double peak = config.hit_share * config.max_distance_m /
                      (config.noise_m * std::sqrt(2.0 * std::numbers::pi));
  double gain = 0.0;
  std::size_t on_surface = 0;
  for (const Eigen::Vector2d& point : b.points_m) {
    const Eigen::Vector2d at = pose * point;
    const std::size_t i = surface.find(at, config.first_gate_m);
    double density = 1.0 - config.hit_share;
    if (i != NearestPoint::kNone) {
      const double rho = a.normals[i].dot(at - a.points_m[i]) / config.noise_m;
      const double apart = (at - a.points_m[i]).norm();
      // Beside the end of a wall the plane goes on, the surface does not.
      const double beside = std::max(0.0, apart - config.last_gate_m) / config.noise_m;
      density += peak * std::exp(-0.5 * (rho * rho + beside * beside));
      on_surface += apart <= config.last_gate_m ? 1 : 0;
    }
    gain += std::log(density);
  }
  match.gain = tempering * gain;
  match.overlap = static_cast<double>(on_surface) / static_cast<double>(b.size());
  const Normal normal =
      normal_equations(surface, b, pose, config.last_gate_m, config.robust_scale_m);
  match.information = tempering / (config.noise_m * config.noise_m) * normal.matrix;
  match.converged = match.overlap >= config.min_overlap && normal.matched >= kMinPoints;
  return match;
}

}  // namespace

double gain_over_look_alikes(double gain, const CloudMatchConfig& config) {
  const double beyond = gain - config.look_alike_gain;
  // ln(1 + exp(beyond)), whose exponent must not overflow.
  return gain - (std::max(beyond, 0.0) + std::log1p(std::exp(-std::abs(beyond))));
}

/// Few points try every start; all points go on from where the best of them came to rest.
PlaceMatch match_clouds(const PlaceSurface& a, const LocalCloud& b,
                        std::span<const Pose2> starts_a_from_b, const CloudMatchConfig& config) {
  PlaceMatch best;
  best.gain = config.failure_gain;
  if (a.cloud().size() < kMinPoints || b.size() < kMinPoints) return best;
  const LocalCloud sample = sample_of(b, kSamplePoints);
  std::vector<PlaceMatch> tried;
  for (const Pose2& start : starts_a_from_b) {
    const Pose2 pose = refine(a, sample, start, config.first_gate_m, config);
    const bool known = std::any_of(tried.begin(), tried.end(), [&](const PlaceMatch& match) {
      return is_about(match.a_from_b, pose);
    });
    if (!known) tried.push_back(judge(a, sample, pose, config));
  }
  std::stable_sort(tried.begin(), tried.end(), [](const PlaceMatch& one, const PlaceMatch& other) {
    return one.gain > other.gain;
  });
  for (std::size_t i = 0; i < std::min(tried.size(), kFinalists); ++i) {
    const Pose2 pose = refine(a, b, tried[i].a_from_b, 2.0 * config.last_gate_m, config);
    const PlaceMatch match = judge(a, b, pose, config);
    if (match.converged && (!best.converged || match.gain > best.gain)) best = match;
  }
  return best;
}

PlaceMatch match_clouds(const LocalCloud& a, const LocalCloud& b,
                        std::span<const Pose2> starts_a_from_b, const CloudMatchConfig& config) {
  return match_clouds(PlaceSurface(a, config.first_gate_m), b, starts_a_from_b, config);
}

}  // namespace strata::topology
