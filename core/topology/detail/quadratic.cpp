// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/quadratic.hpp"

#include <algorithm>
#include <cmath>

#include "core/pose_graph/pose_graph.hpp"
#include "core/topology/detail/row_order.hpp"
#include "core/topology/location_prior.hpp"

namespace strata::topology::detail {
namespace {

/// How a link bends by which it is off: the heading of `a` turns all that is seen from there.
void add_bend(const Link& link, std::span<const Pose2> poses, const Eigen::Vector3d& weighted,
              Quadratic& quadratic) {
  const Pose2& a = poses[link.a];
  const double c = std::cos(a.theta);
  const double s = std::sin(a.theta);
  const Eigen::Vector2d force(c * weighted.x() - s * weighted.y(),
                              s * weighted.x() + c * weighted.y());
  const Eigen::Vector2d across(-force.y(), force.x());
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  own.topRightCorner<2, 1>() = -across;
  own.bottomLeftCorner<1, 2>() = -across.transpose();
  own(2, 2) = -force.dot(poses[link.b].translation() - a.translation());
  Eigen::Matrix3d a_with_b = Eigen::Matrix3d::Zero();
  a_with_b.bottomLeftCorner<1, 2>() = across.transpose();
  quadratic.add(link.a, link.a, own);
  quadratic.add(link.a, link.b, a_with_b);
  quadratic.add(link.b, link.a, a_with_b.transpose());
}

void add_links(const Terms& terms, std::span<const Pose2> poses, Curvature curvature,
               Quadratic& quadratic) {
  for (const Link& link : terms.links) {
    Eigen::Matrix3d by_a;
    Eigen::Matrix3d by_b;
    const Eigen::Vector3d error =
        pose_graph::edge_error(poses[link.a], poses[link.b], link.a_from_b, &by_a, &by_b);
    const Eigen::Vector3d weighted = link.information * error;
    quadratic.add_gradient(link.a, by_a.transpose() * weighted);
    quadratic.add_gradient(link.b, by_b.transpose() * weighted);
    if (!quadratic.with_curvature()) continue;
    const Eigen::Matrix3d weighted_a = link.information * by_a;
    const Eigen::Matrix3d weighted_b = link.information * by_b;
    quadratic.add(link.a, link.a, by_a.transpose() * weighted_a);
    quadratic.add(link.b, link.b, by_b.transpose() * weighted_b);
    quadratic.add(link.a, link.b, by_a.transpose() * weighted_b);
    quadratic.add(link.b, link.a, by_b.transpose() * weighted_a);
    if (curvature == Curvature::kExact) add_bend(link, poses, weighted, quadratic);
  }
}

void add_revisits(const Terms& terms, std::span<const Pose2> poses,
                  const LocationPriorConfig& config, Quadratic& quadratic) {
  const double information = 1.0 / (config.revisit_stddev_m * config.revisit_stddev_m);
  for (const Pair& pair : terms.revisits) {
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    gradient.head<2>() = information * (poses[pair.b].translation() - poses[pair.a].translation());
    quadratic.add_gradient(pair.b, gradient);
    quadratic.add_gradient(pair.a, -gradient);
    if (!quadratic.with_curvature()) continue;
    quadratic.add_apart(pair, information * Eigen::Matrix2d::Identity());
  }
}

Eigen::Matrix2d curvature_of(const Penalty& penalty, const Eigen::Vector2d& apart,
                             Curvature curvature) {
  const auto counted = [curvature](double bend) {
    return curvature == Curvature::kPositive ? std::max(bend, 0.0) : bend;
  };
  const double distance_m = apart.norm();
  if (curvature == Curvature::kRoots) {
    if (distance_m < 1e-6) return Eigen::Matrix2d::Zero();
    const Eigen::Vector2d slope = penalty.slope / distance_m * apart;
    return 0.5 / penalty.value * slope * slope.transpose();
  }
  if (distance_m < 1e-6) return counted(penalty.curve) * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d along = apart / distance_m;
  const Eigen::Matrix2d radial = along * along.transpose();
  return counted(penalty.curve) * radial +
         counted(penalty.slope / distance_m) * (Eigen::Matrix2d::Identity() - radial);
}

void add_penalties(std::span<const Pose2> poses, const LocationPriorConfig& config,
                   Curvature curvature, NearPairs& near, Quadratic& quadratic) {
  if (config.max_penalty <= 0.0) return;
  for (const Pair& pair : near.at(poses)) {
    const Eigen::Vector2d apart = poses[pair.b].translation() - poses[pair.a].translation();
    const Penalty penalty = penalty_at(apart.norm(), config);
    if (!(penalty.value > 0.0)) continue;
    Eigen::Vector3d push = Eigen::Vector3d::Zero();
    if (apart.norm() > 0.0) push.head<2>() = penalty.slope * apart.normalized();
    quadratic.add_gradient(pair.b, push);
    quadratic.add_gradient(pair.a, -push);
    if (quadratic.with_curvature() && curvature != Curvature::kLinks) {
      quadratic.add_apart(pair, curvature_of(penalty, apart, curvature));
    }
  }
}

void add_terms(const Terms& terms, const LocationPriorConfig& config, std::span<const Pose2> poses,
               Curvature curvature, NearPairs& near, Quadratic& quadratic) {
  add_links(terms, poses, curvature, quadratic);
  add_revisits(terms, poses, config, quadratic);
  add_penalties(poses, config, curvature, near, quadratic);
}

}  // namespace

Eigen::VectorXd gradient_at(const Terms& terms, const LocationPriorConfig& config,
                            std::span<const Pose2> poses, const std::vector<int>& rows,
                            NearPairs& near) {
  Quadratic quadratic(rows, std::nullopt);
  add_terms(terms, config, poses, Curvature::kLinks, near, quadratic);
  return quadratic.gradient();
}

Quadratic quadratic_at(const Terms& terms, const LocationPriorConfig& config,
                       std::span<const Pose2> poses, const std::vector<int>& rows,
                       Curvature curvature, NearPairs& near) {
  Quadratic quadratic(rows, pattern_of(touching(terms, config, poses, near), rows));
  add_terms(terms, config, poses, curvature, near, quadratic);
  return quadratic;
}

}  // namespace strata::topology::detail
