// SPDX-License-Identifier: Apache-2.0
#include "core/topology/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <ceres/ceres.h>

#include "core/pose_graph/pose_graph.hpp"
#include "core/topology/location_prior.hpp"

namespace strata::topology {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor23 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
const double kLog2Pi = std::log(2.0 * std::numbers::pi);
/// Penalties reach this much beyond their radius at the start, lest poses move into it unseen.
constexpr double kReachMargin = 1.2;
/// Below this many visits a dense solver is faster.
constexpr std::size_t kDenseVisits = 15;

/// A measured transform between two visits, whitened.
struct Link {
  std::size_t a = 0;
  std::size_t b = 0;
  Pose2 a_from_b;
  Eigen::Matrix3d whitener;  // whitener' * whitener = information
};

struct Pair {
  std::size_t a = 0;
  std::size_t b = 0;
};

/// The factors of one topology, sorted by kind.
struct Terms {
  std::vector<Link> links;
  std::vector<Pair> revisits;
  std::vector<Pair> penalties;
  double log_constant = 0.0;
};

/// A square root that exists for singular information too.
Eigen::Matrix3d square_root(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const Eigen::Vector3d roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return roots.asDiagonal() * solver.eigenvectors().transpose();
}

double distance(const Pose2& a, const Pose2& b) { return translation_distance(a, b); }

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
      if (distance(poses[firsts[i]], poses[firsts[j]]) > reach_m) continue;
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

/// Ceres wants Jacobians row by row, and asks only for some of them.
void write(const Eigen::Matrix3d& jacobian, double* row_major) {
  if (row_major == nullptr) return;
  Eigen::Map<RowMajor3> target(row_major);
  target = jacobian;
}

class LinkCost final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit LinkCost(const Link& link) : link_(link) {}
  bool Evaluate(const double* const* x, double* residuals, double** jacobians) const override {
    const Pose2 a{x[0][0], x[0][1], x[0][2]};
    const Pose2 b{x[1][0], x[1][1], x[1][2]};
    Eigen::Matrix3d by_a;
    Eigen::Matrix3d by_b;
    Eigen::Map<Eigen::Vector3d> whitened(residuals);
    whitened = link_.whitener * pose_graph::edge_error(a, b, link_.a_from_b, &by_a, &by_b);
    if (jacobians == nullptr) return true;
    write(link_.whitener * by_a, jacobians[0]);
    write(link_.whitener * by_b, jacobians[1]);
    return true;
  }

 private:
  Link link_;
};

class RevisitCost final : public ceres::SizedCostFunction<2, 3, 3> {
 public:
  explicit RevisitCost(double stddev_m) : stddev_m_(stddev_m) {}
  bool Evaluate(const double* const* x, double* residuals, double** jacobians) const override {
    for (int k = 0; k < 2; ++k) residuals[k] = (x[1][k] - x[0][k]) / stddev_m_;
    if (jacobians == nullptr) return true;
    for (int pose = 0; pose < 2; ++pose) {
      if (jacobians[pose] == nullptr) continue;
      Eigen::Map<RowMajor23> jacobian(jacobians[pose]);
      jacobian.setZero();
      jacobian(0, 0) = jacobian(1, 1) = (pose == 0 ? -1.0 : 1.0) / stddev_m_;
    }
    return true;
  }

 private:
  double stddev_m_;
};

/// The root of twice the penalty, whose half square is the penalty.
class PenaltyCost final : public ceres::SizedCostFunction<1, 3, 3> {
 public:
  explicit PenaltyCost(const LocationPriorConfig& config) : config_(config) {}
  bool Evaluate(const double* const* x, double* residuals, double** jacobians) const override {
    const Eigen::Vector2d apart(x[1][0] - x[0][0], x[1][1] - x[0][1]);
    const double distance_m = apart.norm();
    const Penalty penalty = penalty_at(distance_m, config_);
    residuals[0] = std::sqrt(2.0 * penalty.value);
    if (jacobians == nullptr) return true;
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    if (residuals[0] > 0.0 && distance_m > 0.0) {
      slope = penalty.slope / residuals[0] * apart / distance_m;
    }
    for (int pose = 0; pose < 2; ++pose) {
      if (jacobians[pose] == nullptr) continue;
      const double sign = pose == 0 ? -1.0 : 1.0;
      jacobians[pose][0] = sign * slope.x();
      jacobians[pose][1] = sign * slope.y();
      jacobians[pose][2] = 0.0;
    }
    return true;
  }

 private:
  const LocationPriorConfig& config_;
};

/// Moves the poses to the least cost; returns whether that converged.
bool optimize(const Terms& terms, const LocationPriorConfig& config, std::vector<Pose2>& poses,
              double& cost) {
  static_assert(sizeof(Pose2) == 3 * sizeof(double));
  const auto block = [&](std::size_t i) { return &poses[i].x; };
  ceres::Problem problem;
  problem.AddParameterBlock(block(0), 3);
  problem.SetParameterBlockConstant(block(0));
  for (const Link& link : terms.links) {
    problem.AddResidualBlock(new LinkCost(link), nullptr, block(link.a), block(link.b));
  }
  for (const Pair& pair : terms.revisits) {
    problem.AddResidualBlock(new RevisitCost(config.revisit_stddev_m), nullptr, block(pair.a),
                             block(pair.b));
  }
  for (const Pair& pair : terms.penalties) {
    problem.AddResidualBlock(new PenaltyCost(config), nullptr, block(pair.a), block(pair.b));
  }
  ceres::Solver::Options options;
  options.linear_solver_type =
      poses.size() <= kDenseVisits ? ceres::DENSE_NORMAL_CHOLESKY : ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-9;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  cost = summary.final_cost;
  return summary.termination_type == ceres::CONVERGENCE && std::isfinite(cost);
}

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
  void add_pair(const Pair& pair, const Eigen::Matrix3d& block) {
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

Hessian hessian_without_penalties(const Terms& terms, std::span<const Pose2> poses,
                                  const LocationPriorConfig& config) {
  Hessian hessian(poses.size());
  for (const Link& link : terms.links) {
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
  for (const Pair& pair : terms.revisits) hessian.add_pair(pair, revisit);
  return hessian;
}

bool factorize(const Terms& terms, std::span<const Pose2> poses, const LocationPriorConfig& config,
               Hessian::Factor& factor) {
  const Hessian plain = hessian_without_penalties(terms, poses, config);
  if (!terms.penalties.empty()) {
    Hessian full = plain;
    for (const Pair& pair : terms.penalties) {
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

OdometryFactor odometry_factor(const Pose2& from_from_to, double way_m,
                               const OdometryNoiseConfig& config) {
  const double sigma_m = config.floor_m + config.per_metre_m * way_m;
  const double sigma_rad = config.floor_rad + config.per_metre_rad * way_m;
  OdometryFactor factor;
  factor.mean = from_from_to;
  factor.covariance =
      Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
  return factor;
}

Evidence evaluate(const Labels& labels, const Measurements& measurements,
                  std::span<const ScanFactor> scans, std::vector<Pose2> start,
                  const LocationPriorConfig& config) {
  Evidence evidence;
  evidence.poses = std::move(start);
  if (labels.size() < 2) {
    evidence.converged = true;
    return evidence;
  }
  const Terms terms = collect(labels, measurements, scans, evidence.poses, config);
  double cost = 0.0;
  evidence.converged = optimize(terms, config, evidence.poses, cost);
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
  if (!factorize(collect(labels, measurements, scans, poses, config), poses, config, factor)) {
    return covariances;
  }
  for (std::size_t i = 1; i < labels.size(); ++i) covariances[i] = covariance_of(factor, i);
  return covariances;
}

}  // namespace strata::topology
