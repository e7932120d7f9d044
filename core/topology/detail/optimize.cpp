// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>

#include "core/pose_graph/edge_cost.hpp"
#include "core/topology/detail/terms.hpp"
#include "core/topology/location_prior.hpp"

namespace strata::topology::detail {
namespace {

using RowMajor23 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
/// Up to this many visits a dense solver is faster.
constexpr std::size_t kDenseVisits = 15;

/// Penalties reach this much beyond their radius at the start; poses that move into the radius
/// unseen ask for another round.
constexpr double kReachMargin = 1.2;
constexpr int kMaxRounds = 5;

/// A square root that exists for singular information too: root' * root = information.
Eigen::Matrix3d square_root(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const Eigen::Vector3d roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return roots.asDiagonal() * solver.eigenvectors().transpose();
}

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

bool solve(const Terms& terms, const std::vector<Pair>& penalties,
           const LocationPriorConfig& config, std::vector<Pose2>& poses) {
  static_assert(sizeof(Pose2) == 3 * sizeof(double));
  const auto block = [&](std::size_t i) { return &poses[i].x; };
  ceres::Problem problem;
  problem.AddParameterBlock(block(0), 3);
  problem.SetParameterBlockConstant(block(0));
  for (const Link& link : terms.links) {
    problem.AddResidualBlock(
        pose_graph::new_edge_cost(link.a_from_b, square_root(link.information)), nullptr,
        block(link.a), block(link.b));
  }
  for (const Pair& pair : terms.revisits) {
    problem.AddResidualBlock(new RevisitCost(config.revisit_stddev_m), nullptr, block(pair.a),
                             block(pair.b));
  }
  for (const Pair& pair : penalties) {
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
  return summary.termination_type == ceres::CONVERGENCE;
}

}  // namespace

bool optimize(const Terms& terms, const LocationPriorConfig& config, std::vector<Pose2>& poses,
              double& cost) {
  const bool penalized = config.max_penalty > 0.0;
  const double reach_m = penalized ? kReachMargin * config.penalty_radius_m : 0.0;
  std::vector<Pair> penalties = near_pairs(terms.landmarks, poses, reach_m);
  for (int round = 0; round < kMaxRounds; ++round) {
    if (!solve(terms, penalties, config, poses)) return false;
    const std::size_t known = penalties.size();
    for (const Pair& pair :
         near_pairs(terms.landmarks, poses, penalized ? config.penalty_radius_m : 0.0)) {
      const bool is_known =
          std::any_of(penalties.begin(), penalties.begin() + static_cast<std::ptrdiff_t>(known),
                      [&](const Pair& other) { return other.a == pair.a && other.b == pair.b; });
      if (!is_known) penalties.push_back(pair);
    }
    if (penalties.size() > known) continue;
    cost = cost_at(terms, poses, config);
    return std::isfinite(cost);
  }
  return false;
}

}  // namespace strata::topology::detail
