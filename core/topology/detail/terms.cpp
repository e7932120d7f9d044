// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/terms.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace strata::topology::detail {
namespace {

const double kLog2Pi = std::log(2.0 * std::numbers::pi);
/// Penalties reach this much beyond their radius at the start, lest poses move into it unseen.
constexpr double kReachMargin = 1.2;

/// A square root that exists for singular information too.
Eigen::Matrix3d square_root(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const Eigen::Vector3d roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return roots.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

Terms collect(const Labels& labels, const Measurements& measurements,
              std::span<const ScanFactor> scans, std::span<const Pose2> poses,
              const LocationPriorConfig& config) {
  Terms terms;
  for (std::size_t i = 0; i + 1 < labels.size(); ++i) {
    const OdometryFactor& odometry = measurements.odometry[i];
    terms.links.push_back({i, i + 1, odometry.mean, square_root(odometry.covariance.inverse())});
    terms.log_constant -= 0.5 * (3.0 * kLog2Pi + std::log(odometry.covariance.determinant()));
  }
  const double variance = config.revisit_stddev_m * config.revisit_stddev_m;
  const std::vector<std::size_t> firsts = first_visits(labels);
  for (std::size_t i = 1; i < labels.size(); ++i) {
    const std::size_t first = firsts[static_cast<std::size_t>(labels[i])];
    if (first == i) {
      terms.log_constant += measurements.log_new_density[i];
    } else {
      terms.revisits.push_back({first, i});
      terms.log_constant -= 2.0 * kLog2Pi + std::log(variance);
    }
  }
  const double reach_m = kReachMargin * config.penalty_radius_m;
  for (std::size_t j = 1; j < firsts.size() && config.max_penalty > 0.0; ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (translation_distance(poses[firsts[i]], poses[firsts[j]]) > reach_m) continue;
      terms.penalties.push_back({firsts[i], firsts[j]});
    }
  }
  for (const ScanFactor& scan : scans) {
    terms.log_constant += scan.match.gain;
    if (!scan.match.converged) continue;
    terms.links.push_back(
        {scan.from, scan.to, scan.match.a_from_b, square_root(scan.match.information)});
  }
  return terms;
}

}  // namespace strata::topology::detail
