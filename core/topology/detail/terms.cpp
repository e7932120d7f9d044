// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/terms.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "core/pose_graph/pose_graph.hpp"
#include "core/topology/location_prior.hpp"

namespace strata::topology::detail {
namespace {

const double kLog2Pi = std::log(2.0 * std::numbers::pi);

}  // namespace

Terms collect(const Labels& labels, const Measurements& measurements,
              std::span<const ScanFactor> scans, const LocationPriorConfig& config) {
  Terms terms;
  terms.links.reserve(labels.size() + scans.size());
  for (std::size_t i = 0; i + 1 < labels.size(); ++i) {
    const OdometryFactor& odometry = measurements.odometry[i];
    terms.links.push_back({i, i + 1, odometry.mean, odometry.covariance.inverse()});
    terms.log_constant -= 0.5 * (3.0 * kLog2Pi + std::log(odometry.covariance.determinant()));
  }
  const double variance = config.revisit_stddev_m * config.revisit_stddev_m;
  terms.landmarks = first_visits(labels);
  for (std::size_t i = 1; i < labels.size(); ++i) {
    const std::size_t first = terms.landmarks[static_cast<std::size_t>(labels[i])];
    if (first == i) {
      terms.log_constant += measurements.log_new_density[i];
    } else {
      terms.revisits.push_back({first, i});
      terms.log_constant -= 2.0 * kLog2Pi + std::log(variance);
    }
  }
  for (const ScanFactor& scan : scans) {
    terms.log_constant += scan.match.gain;
    if (!scan.match.converged) continue;
    terms.links.push_back({scan.from, scan.to, scan.match.a_from_b, scan.match.information});
  }
  return terms;
}

std::vector<Pair> near_pairs(const Terms& terms, std::span<const Pose2> poses, double reach_m) {
  std::vector<Pair> pairs;
  const double squared = reach_m * reach_m;
  for (std::size_t j = 1; j < terms.landmarks.size(); ++j) {
    const Pose2& b = poses[terms.landmarks[j]];
    for (std::size_t i = 0; i < j; ++i) {
      const Pose2& a = poses[terms.landmarks[i]];
      const double x = b.x - a.x;
      const double y = b.y - a.y;
      if (x * x + y * y < squared) pairs.push_back({terms.landmarks[i], terms.landmarks[j]});
    }
  }
  return pairs;
}

double cost_at(const Terms& terms, std::span<const Pose2> poses,
               const LocationPriorConfig& config) {
  double cost = 0.0;
  for (const Link& link : terms.links) {
    const Eigen::Vector3d error =
        pose_graph::edge_error(poses[link.a], poses[link.b], link.a_from_b);
    cost += 0.5 * error.dot(link.information * error);
  }
  const double information = 1.0 / (config.revisit_stddev_m * config.revisit_stddev_m);
  for (const Pair& pair : terms.revisits) {
    cost += 0.5 * information *
            (poses[pair.b].translation() - poses[pair.a].translation()).squaredNorm();
  }
  if (config.max_penalty <= 0.0) return cost;
  for (const Pair& pair : near_pairs(terms, poses, config.penalty_radius_m)) {
    cost += penalty_at(translation_distance(poses[pair.a], poses[pair.b]), config).value;
  }
  return cost;
}

}  // namespace strata::topology::detail
