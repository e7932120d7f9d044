// SPDX-License-Identifier: Apache-2.0
#include "core/pose_graph/pose_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

#include "core/base/error.hpp"
#include "core/base/make_room.hpp"
#include "core/geometry/angle.hpp"
#include "core/pose_graph/edge_cost.hpp"

namespace strata::pose_graph {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Matrix3d whitener(const Eigen::Matrix3d& information) { return information.llt().matrixU(); }

/// Ceres wants Jacobians row by row, and asks only for some of them.
void write(const Eigen::Matrix3d& jacobian, double* row_major) {
  if (row_major == nullptr) return;
  Eigen::Map<RowMajor3> target(row_major);
  target = jacobian;
}

class EdgeCost final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  EdgeCost(const Pose2& a_from_b, const Eigen::Matrix3d& root)
      : a_from_b_(a_from_b), whitener_(root) {}
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Pose2 a{parameters[0][0], parameters[0][1], parameters[0][2]};
    const Pose2 b{parameters[1][0], parameters[1][1], parameters[1][2]};
    Eigen::Matrix3d by_a;
    Eigen::Matrix3d by_b;
    Eigen::Map<Eigen::Vector3d> whitened(residuals);
    whitened = whitener_ * edge_error(a, b, a_from_b_, &by_a, &by_b);
    if (jacobians == nullptr) return true;
    write(whitener_ * by_a, jacobians[0]);
    write(whitener_ * by_b, jacobians[1]);
    return true;
  }

 private:
  Pose2 a_from_b_;
  Eigen::Matrix3d whitener_;
};

class PriorCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  explicit PriorCost(const Prior& prior)
      : mean_(prior.map_from_node), whitener_(whitener(prior.information)) {}
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::Vector3d> whitened(residuals);
    whitened = whitener_ * Eigen::Vector3d(parameters[0][0] - mean_.x, parameters[0][1] - mean_.y,
                                           angle_difference(parameters[0][2], mean_.theta));
    if (jacobians != nullptr) write(whitener_, jacobians[0]);
    return true;
  }

 private:
  Pose2 mean_;
  Eigen::Matrix3d whitener_;
};

void require_information(const Eigen::Matrix3d& information, const std::string& place) {
  const bool usable = information.allFinite() && information.isApprox(information.transpose()) &&
                      information.llt().info() == Eigen::Success;
  if (!usable) {
    throw InputError(place, "information is not symmetric positive definite",
                     "pass the inverse of a covariance of full rank");
  }
}

}  // namespace

Eigen::Vector3d edge_error(const Pose2& map_from_a, const Pose2& map_from_b, const Pose2& a_from_b,
                           Eigen::Matrix3d* by_a, Eigen::Matrix3d* by_b) {
  const double c = std::cos(map_from_a.theta);
  const double s = std::sin(map_from_a.theta);
  const double dx = map_from_b.x - map_from_a.x;
  const double dy = map_from_b.y - map_from_a.y;
  const double x = c * dx + s * dy;
  const double y = -s * dx + c * dy;
  if (by_a != nullptr) *by_a << -c, -s, y, s, -c, -x, 0.0, 0.0, -1.0;
  if (by_b != nullptr) *by_b << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  return {x - a_from_b.x, y - a_from_b.y,
          wrap_angle(map_from_b.theta - map_from_a.theta - a_from_b.theta)};
}

ceres::CostFunction* new_edge_cost(const Pose2& a_from_b, const Eigen::Matrix3d& root) {
  return new EdgeCost(a_from_b, root);
}

PoseGraph::PoseGraph(const PoseGraphConfig& config) : config_(config) {
  require_valid(config, "pose_graph");
}

void PoseGraph::make_room() {
  make_room_for_one(poses_);
  make_room_for_one(fixed_);
  make_room_for_one(edges_);
  make_room_for_one(enabled_);
  make_room_for_one(priors_);
}

std::size_t PoseGraph::add_node(const Pose2& map_from_node, bool fixed) {
  poses_.push_back(map_from_node);
  fixed_.push_back(fixed);
  return poses_.size() - 1;
}

std::size_t PoseGraph::add_edge(const Edge& edge) {
  const std::string place = "edge " + std::to_string(edges_.size());
  if (edge.from >= size() || edge.to >= size() || edge.from == edge.to) {
    throw InputError(place, "does not join two different nodes of the graph", "add nodes first");
  }
  require_information(edge.information, place);
  edges_.push_back(edge);
  enabled_.push_back(true);
  return edges_.size() - 1;
}

void PoseGraph::add_prior(const Prior& prior) {
  const std::string place = "prior " + std::to_string(priors_.size());
  if (prior.node >= size()) throw InputError(place, "has no node", "add the node first");
  require_information(prior.information, place);
  priors_.push_back(prior);
}

double PoseGraph::squared_error(std::size_t edge) const {
  const Edge& e = edges_[edge];
  const Eigen::Vector3d error = edge_error(poses_[e.from], poses_[e.to], e.from_from_to);
  return error.dot(e.information * error);
}

bool PoseGraph::is_sound() const {
  const std::size_t count = poses_.size();
  return fixed_.size() == count && enabled_.size() == edges_.size() &&
         std::all_of(edges_.begin(), edges_.end(),
                     [&](const Edge& edge) { return edge.from < count && edge.to < count; }) &&
         std::all_of(priors_.begin(), priors_.end(),
                     [&](const Prior& prior) { return prior.node < count; });
}

std::vector<bool> PoseGraph::held_nodes() const {
  std::vector<std::size_t> parent(size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  auto root = [&](std::size_t node) {
    while (parent[node] != node) node = parent[node] = parent[parent[node]];
    return node;
  };
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (!enabled_[i]) continue;
    const std::size_t a = root(edges_[i].from);
    const std::size_t b = root(edges_[i].to);
    // The least index becomes the root, so that the first node of a part is the one held.
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::vector<bool> anchored(size(), false);
  for (std::size_t i = 0; i < size(); ++i) {
    if (fixed_[i]) anchored[root(i)] = true;
  }
  for (const Prior& prior : priors_) anchored[root(prior.node)] = true;
  std::vector<bool> held = fixed_;
  for (std::size_t i = 0; i < size(); ++i) {
    if (root(i) == i && !anchored[i]) held[i] = true;
  }
  return held;
}

PoseGraphResult PoseGraph::optimize() {
  std::vector<std::array<double, 3>> values(size());
  for (std::size_t i = 0; i < size(); ++i) {
    values[i] = {poses_[i].x, poses_[i].y, poses_[i].theta};
  }
  ceres::Problem problem;
  for (auto& value : values) problem.AddParameterBlock(value.data(), 3);
  auto loss = [&](bool robust) -> ceres::LossFunction* {
    return robust ? new ceres::CauchyLoss(config_.robust_scale) : nullptr;
  };
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (!enabled_[i]) continue;
    const Edge& e = edges_[i];
    problem.AddResidualBlock(new_edge_cost(e.from_from_to, whitener(e.information)), loss(e.robust),
                             values[e.from].data(), values[e.to].data());
  }
  for (const Prior& prior : priors_) {
    problem.AddResidualBlock(new PriorCost(prior), loss(prior.robust), values[prior.node].data());
  }
  const std::vector<bool> held = held_nodes();
  for (std::size_t i = 0; i < size(); ++i) {
    if (held[i]) problem.SetParameterBlockConstant(values[i].data());
  }
  PoseGraphResult result;
  if (problem.NumResidualBlocks() == 0) {
    result.converged = true;
    return result;
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // Eigen's factorization calls no BLAS, whose threads could change the order of sums.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  options.max_num_iterations = config_.max_iterations;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  result = {summary.termination_type == ceres::CONVERGENCE,
            static_cast<int>(summary.iterations.size()), summary.initial_cost, summary.final_cost};
  if (!summary.IsSolutionUsable()) return result;
  for (std::size_t i = 0; i < size(); ++i) {
    poses_[i] = {values[i][0], values[i][1], wrap_angle(values[i][2])};
  }
  return result;
}

}  // namespace strata::pose_graph
