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
  by_last_.setIdentity();
  by_last_(0, 2) = -lever.y();
  by_last_(1, 2) = lever.x();
  const auto rows = 3 * static_cast<Eigen::Index>(poses.size());
  with_newest_.resize(rows + 3, 3);
  with_newest_.topRows(rows) = with_last * by_last_.transpose();
  with_newest_.bottomRows<3>() = newest.covariance;
}

const Eigen::Matrix3d& Prediction::covariance_between(std::size_t visit, std::size_t other) {
  const auto found = between_.find({visit, other});
  if (found != between_.end()) return found->second;
  return between_.emplace(std::pair(visit, other), gaussian_.covariance_between(visit, other))
      .first->second;
}

Eigen::Matrix2d Prediction::covariance_apart(std::size_t visit) {
  return covariance_apart(visit, covariance_between(visit, visit));
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
  const Eigen::Matrix3d newest = with_newest_.bottomRows<3>();
  Stack covariance(size, size);
  Stack information = Stack::Zero(size, size);
  Stack with_newest(3, size);  // covariance of the newest pose with the errors
  StackVector error(size);
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    const LinearizedFactor& factor = factors[k];
    with_newest.middleCols<3>(row) =
        block_of(with_newest_, factor.visit).transpose() * factor.by_visit.transpose() +
        newest * factor.by_newest.transpose();
    for (std::size_t l = 0; l < factors.size(); ++l) {
      const Eigen::Matrix3d with_error =
          covariance_between(factors[l].visit, factor.visit) * factor.by_visit.transpose() +
          block_of(with_newest_, factors[l].visit) * factor.by_newest.transpose();
      covariance.block<3, 3>(3 * static_cast<Eigen::Index>(l), row) =
          factors[l].by_visit * with_error + factors[l].by_newest * with_newest.middleCols<3>(row);
    }
    information.block<3, 3>(row, row) = factor.information;
    error.segment<3>(row) = factor.error;
  }
  const Stack both = Stack::Identity(size, size) + information * covariance;
  const Eigen::PartialPivLU<Stack> solver(both);
  const StackVector weighted_error = information * error;
  const StackVector force = solver.solve(weighted_error);
  Conditioned conditioned;
  conditioned.log_factor = -0.5 * error.dot(force) - 0.5 * std::log(std::abs(solver.determinant()));
  std::vector<std::pair<std::size_t, Eigen::Vector3d>> forces;
  Eigen::Vector3d on_newest = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const Eigen::Vector3d of_factor = force.segment<3>(3 * static_cast<Eigen::Index>(k));
    forces.emplace_back(factors[k].visit, -factors[k].by_visit.transpose() * of_factor);
    on_newest -= factors[k].by_newest.transpose() * of_factor;
  }
  forces.emplace_back(poses_.size() - 1, by_last_.transpose() * on_newest);
  const Eigen::VectorXd shift = gaussian_.moved_by(forces);
  const Eigen::Vector3d shift_of_newest = -(with_newest * force);
  const auto shifted = [](const Pose2& pose, const Eigen::Vector3d& by) {
    return Pose2{pose.x + by.x(), pose.y + by.y(), wrap_angle(pose.theta + by.z())};
  };
  conditioned.poses.reserve(poses_.size() + 1);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    conditioned.poses.push_back(
        shifted(poses_[i], shift.segment<3>(3 * static_cast<Eigen::Index>(i))));
  }
  conditioned.poses.push_back(shifted(newest_, shift_of_newest));
  return conditioned;
}

}  // namespace strata::topology
