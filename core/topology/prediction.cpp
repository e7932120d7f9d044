// SPDX-License-Identifier: Apache-2.0
#include "core/topology/prediction.hpp"

#include <cmath>

#include <Eigen/LU>

#include "core/geometry/angle.hpp"
#include "core/pose_graph/pose_graph.hpp"

namespace strata::topology {
namespace {

using Stack = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using StackVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

Eigen::Matrix2d position(const Eigen::Matrix3d& covariance) {
  return covariance.topLeftCorner<2, 2>();
}

}  // namespace

Prediction::Prediction(std::span<const Pose2> poses, const LocationGaussian& gaussian,
                       const OdometryFactor& odometry)
    : poses_(poses), gaussian_(gaussian) {
  const Eigen::MatrixX3d with_last = gaussian.covariance_with(poses.size() - 1);
  const Pose2Gaussian last{poses.back(), block_of(with_last, poses.size() - 1)};
  const Pose2Gaussian newest = last * odometry;
  newest_ = newest.mean;
  const Eigen::Vector2d lever = newest_.translation() - poses.back().translation();
  Eigen::Matrix3d by_last = Eigen::Matrix3d::Identity();
  by_last(0, 2) = -lever.y();
  by_last(1, 2) = lever.x();
  const auto rows = 3 * static_cast<Eigen::Index>(poses.size());
  with_newest_.resize(rows + 3, 3);
  with_newest_.topRows(rows) = with_last * by_last.transpose();
  with_newest_.bottomRows<3>() = newest.covariance;
}

const Eigen::MatrixX3d& Prediction::with(std::size_t visit) {
  const auto found = with_.find(visit);
  if (found != with_.end()) return found->second;
  const auto rows = 3 * static_cast<Eigen::Index>(poses_.size());
  Eigen::MatrixX3d all(rows + 3, 3);
  all.topRows(rows) = gaussian_.covariance_with(visit);
  all.bottomRows<3>() = block_of(with_newest_, visit).transpose();
  return with_.emplace(visit, std::move(all)).first->second;
}

Eigen::Matrix2d Prediction::covariance_apart(std::size_t visit) {
  return covariance_apart(visit, block_of(with(visit), visit));
}

Eigen::Matrix2d Prediction::covariance_apart(std::size_t visit,
                                             const Eigen::Matrix3d& bound) const {
  const Eigen::Matrix2d across = position(block_of(with_newest_, visit));
  return position(with_newest_.bottomRows<3>()) + position(bound) - across - across.transpose();
}

LinearizedFactor Prediction::same_place_factor(std::size_t visit,
                                               const LocationPriorConfig& config) const {
  LinearizedFactor factor;
  factor.visit = visit;
  factor.error.head<2>() = newest_.translation() - poses_[visit].translation();
  factor.by_newest(0, 0) = factor.by_newest(1, 1) = 1.0;
  factor.by_visit = -factor.by_newest;
  factor.information(0, 0) = factor.information(1, 1) =
      1.0 / (config.revisit_stddev_m * config.revisit_stddev_m);
  return factor;
}

LinearizedFactor Prediction::registration_factor(std::size_t visit, const PlaceMatch& match) const {
  LinearizedFactor factor;
  factor.visit = visit;
  factor.error = pose_graph::edge_error(poses_[visit], newest_, match.a_from_b, &factor.by_visit,
                                        &factor.by_newest);
  factor.information = match.information;
  return factor;
}

/// With Q the covariance of the errors and W their information, the mean of exp(-e'We/2) is
/// |I + WQ|^-1/2 exp(-h'(I + WQ)^-1 W h / 2), h the expected errors; W may be singular.
Prediction::Conditioned Prediction::conditioned_on(std::span<const LinearizedFactor> factors) {
  const auto size = 3 * static_cast<Eigen::Index>(factors.size());
  const auto rows = with_newest_.rows();
  Eigen::MatrixXd with_errors(rows, size);  // covariance of all poses with the errors
  for (std::size_t k = 0; k < factors.size(); ++k) {
    with_errors.middleCols<3>(3 * static_cast<Eigen::Index>(k)).noalias() =
        with(factors[k].visit) * factors[k].by_visit.transpose() +
        with_newest_ * factors[k].by_newest.transpose();
  }
  Stack covariance(size, size);
  Stack information = Stack::Zero(size, size);
  StackVector error(size);
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    covariance.middleRows<3>(row) =
        factors[k].by_visit *
            with_errors.middleRows<3>(3 * static_cast<Eigen::Index>(factors[k].visit)) +
        factors[k].by_newest * with_errors.bottomRows<3>();
    information.block<3, 3>(row, row) = factors[k].information;
    error.segment<3>(row) = factors[k].error;
  }
  const Stack both = Stack::Identity(size, size) + information * covariance;
  const Eigen::PartialPivLU<Stack> solver(both);
  const StackVector weighted_error = information * error;
  const StackVector force = solver.solve(weighted_error);
  Conditioned conditioned;
  conditioned.log_factor = -0.5 * error.dot(force) - 0.5 * std::log(std::abs(solver.determinant()));
  const Eigen::VectorXd shift = -(with_errors * force);
  conditioned.poses.assign(poses_.begin(), poses_.end());
  conditioned.poses.push_back(newest_);
  for (std::size_t i = 0; i < conditioned.poses.size(); ++i) {
    Pose2& pose = conditioned.poses[i];
    const Eigen::Vector3d by = shift.segment<3>(3 * static_cast<Eigen::Index>(i));
    pose = {pose.x + by.x(), pose.y + by.y(), wrap_angle(pose.theta + by.z())};
  }
  return conditioned;
}

}  // namespace strata::topology
