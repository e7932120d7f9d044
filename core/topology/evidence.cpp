// SPDX-License-Identifier: Apache-2.0
#include "core/topology/evidence.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include "core/pose_graph/pose_graph.hpp"
#include "core/topology/detail/terms.hpp"
#include "core/topology/location_prior.hpp"

namespace strata::topology {
namespace {

const double kLog2Pi = std::log(2.0 * std::numbers::pi);

/// The curvature of the cost by all poses but the first. Adds blocks of whitened Jacobians.
class Hessian {
 public:
  explicit Hessian(std::size_t visits) : size_(3 * (static_cast<int>(visits) - 1)) {
    for (int i = 0; i < size_; ++i) triplets_.emplace_back(i, i, 0.0);
  }
  void add(std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
    if (a == 0 || b == 0) return;
    const int row = 3 * (static_cast<int>(a) - 1);
    const int column = 3 * (static_cast<int>(b) - 1);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        if (row + r >= column + c && block(r, c) != 0.0) {
          triplets_.emplace_back(row + r, column + c, block(r, c));
        }
      }
    }
  }
  void add_pair(const detail::Pair& pair, const Eigen::Matrix3d& block) {
    add(pair.a, pair.a, block);
    add(pair.b, pair.b, block);
    add(pair.a, pair.b, -block);
    add(pair.b, pair.a, -block);
  }
  using Factor = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;
  [[nodiscard]] bool factorize(Factor& factor) const {
    Eigen::SparseMatrix<double> matrix(size_, size_);
    matrix.setFromTriplets(triplets_.begin(), triplets_.end());
    factor.compute(matrix);
    return factor.info() == Eigen::Success;
  }
  [[nodiscard]] int size() const { return size_; }

 private:
  int size_;
  std::vector<Eigen::Triplet<double>> triplets_;
};

Eigen::Matrix3d penalty_curvature(const Pose2& a, const Pose2& b,
                                  const LocationPriorConfig& config) {
  const Eigen::Vector2d apart = b.translation() - a.translation();
  const double distance_m = apart.norm();
  const Penalty penalty = penalty_at(distance_m, config);
  Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
  if (distance_m < 1e-6) {
    block.topLeftCorner<2, 2>() = penalty.curve * Eigen::Matrix2d::Identity();
    return block;
  }
  const Eigen::Vector2d along = apart / distance_m;
  const Eigen::Matrix2d radial = along * along.transpose();
  block.topLeftCorner<2, 2>() =
      penalty.curve * radial + penalty.slope / distance_m * (Eigen::Matrix2d::Identity() - radial);
  return block;
}

Hessian hessian_without_penalties(const detail::Terms& terms, std::span<const Pose2> poses,
                                  const LocationPriorConfig& config) {
  Hessian hessian(poses.size());
  for (const detail::Link& link : terms.links) {
    Eigen::Matrix3d by_a;
    Eigen::Matrix3d by_b;
    (void)pose_graph::edge_error(poses[link.a], poses[link.b], link.a_from_b, &by_a, &by_b);
    const Eigen::Matrix3d a = link.whitener * by_a;
    const Eigen::Matrix3d b = link.whitener * by_b;
    hessian.add(link.a, link.a, a.transpose() * a);
    hessian.add(link.b, link.b, b.transpose() * b);
    hessian.add(link.a, link.b, a.transpose() * b);
    hessian.add(link.b, link.a, b.transpose() * a);
  }
  Eigen::Matrix3d revisit = Eigen::Matrix3d::Zero();
  revisit(0, 0) = revisit(1, 1) = 1.0 / (config.revisit_stddev_m * config.revisit_stddev_m);
  for (const detail::Pair& pair : terms.revisits) hessian.add_pair(pair, revisit);
  return hessian;
}

bool factorize(const detail::Terms& terms, std::span<const Pose2> poses,
               const LocationPriorConfig& config, Hessian::Factor& factor) {
  const Hessian plain = hessian_without_penalties(terms, poses, config);
  if (!terms.penalties.empty()) {
    Hessian full = plain;
    for (const detail::Pair& pair : terms.penalties) {
      full.add_pair(pair, penalty_curvature(poses[pair.a], poses[pair.b], config));
    }
    if (full.factorize(factor)) return true;
  }
  return plain.factorize(factor);
}

Eigen::Matrix3d covariance_of(const Hessian::Factor& factor, std::size_t visit) {
  const auto size = factor.rows();
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(size, 3);
  const auto row = 3 * (static_cast<Eigen::Index>(visit) - 1);
  unit.block<3, 3>(row, 0).setIdentity();
  const Eigen::MatrixXd solved = factor.solve(unit);
  const Eigen::Matrix3d block = solved.block<3, 3>(row, 0);
  return 0.5 * (block + block.transpose());
}

}  // namespace

Evidence evaluate(const Labels& labels, const Measurements& measurements,
                  std::span<const ScanFactor> scans, std::vector<Pose2> start,
                  const LocationPriorConfig& config) {
  Evidence evidence;
  evidence.poses = std::move(start);
  if (labels.size() < 2) {
    evidence.converged = true;
    return evidence;
  }
  const detail::Terms terms = detail::collect(labels, measurements, scans, evidence.poses, config);
  double cost = 0.0;
  evidence.converged = detail::optimize(terms, config, evidence.poses, cost);
  Hessian::Factor factor;
  if (!factorize(terms, evidence.poses, config, factor)) {
    evidence.converged = false;
    return evidence;
  }
  double log_determinant = 0.0;
  const Eigen::SparseMatrix<double> lower = factor.matrixL();
  for (int i = 0; i < lower.rows(); ++i) log_determinant += 2.0 * std::log(lower.coeff(i, i));
  evidence.log_evidence = terms.log_constant - cost +
                          0.5 * static_cast<double>(factor.rows()) * kLog2Pi -
                          0.5 * log_determinant;
  evidence.newest_covariance = covariance_of(factor, labels.size() - 1);
  return evidence;
}

std::vector<Eigen::Matrix3d> marginal_covariances(const Labels& labels,
                                                  const Measurements& measurements,
                                                  std::span<const ScanFactor> scans,
                                                  std::span<const Pose2> poses,
                                                  const LocationPriorConfig& config) {
  std::vector<Eigen::Matrix3d> covariances(labels.size(), Eigen::Matrix3d::Zero());
  if (labels.size() < 2) return covariances;
  Hessian::Factor factor;
  if (!factorize(detail::collect(labels, measurements, scans, poses, config), poses, config,
                 factor)) {
    return covariances;
  }
  for (std::size_t i = 1; i < labels.size(); ++i) covariances[i] = covariance_of(factor, i);
  return covariances;
}

}  // namespace strata::topology
