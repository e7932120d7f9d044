// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/terms.hpp"

#include <cmath>
#include <numbers>

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
    terms.links.push_back({i, i + 1, odometry.mean, odometry.information});
    terms.log_constant -= odometry.log_normalizer;
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

double cost_at(const Terms& terms, std::span<const Pose2> poses,
               const LocationPriorConfig& config) {
  NearPairs near(terms.landmarks, config.penalty_radius_m);
  return cost_at(terms, poses, config, near);
}

double cost_at(const Terms& terms, std::span<const Pose2> poses, const LocationPriorConfig& config,
               NearPairs& near) {
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
  for (const Pair& pair : near.at(poses)) {
    cost += penalty_at(translation_distance(poses[pair.a], poses[pair.b]), config).value;
  }
  return cost;
}

}  // namespace strata::topology::detail
