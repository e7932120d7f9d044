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
  const Pose2Gaussian last{poses.back(),
                           block_of(gaussian.covariance_with(poses.size() - 1), poses.size() - 1)};
  const Pose2Gaussian newest = last * odometry;
  newest_ = newest.mean;
  const Eigen::Vector2d lever = newest_.translation() - poses.back().translation();
  Eigen::Matrix3d by_last = Eigen::Matrix3d::Identity();
  by_last(0, 2) = -lever.y();
  by_last(1, 2) = lever.x();
  const auto rows = 3 * static_cast<Eigen::Index>(poses.size());
  with_newest_.resize(rows + 3, 3);
  with_newest_.topRows(rows) = gaussian.covariance_with(poses.size() - 1) * by_last.transpose();
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

Pull Prediction::same_place(std::size_t visit, const LocationPriorConfig& config) const {
  Pull pull;
  pull.visit = visit;
  pull.error.head<2>() = newest_.translation() - poses_[visit].translation();
  pull.by_newest(0, 0) = pull.by_newest(1, 1) = 1.0;
  pull.by_visit = -pull.by_newest;
  pull.information(0, 0) = pull.information(1, 1) =
      1.0 / (config.revisit_stddev_m * config.revisit_stddev_m);
  return pull;
}

Pull Prediction::laid_on(std::size_t visit, const PlaceMatch& match) const {
  Pull pull;
  pull.visit = visit;
  pull.error = pose_graph::edge_error(poses_[visit], newest_, match.a_from_b, &pull.by_visit,
                                      &pull.by_newest);
  pull.information = match.information;
  return pull;
}

/// With Q the covariance of the errors and W their information, the mean of exp(-e'We/2) is
/// |I + WQ|^-1/2 exp(-h'(I + WQ)^-1 W h / 2), h the expected errors; W may be singular.
Prediction::Pulled Prediction::pulled_by(std::span<const Pull> pulls) {
  const auto size = 3 * static_cast<Eigen::Index>(pulls.size());
  const auto rows = with_newest_.rows();
  Eigen::MatrixXd with_errors(rows, size);  // covariance of all poses with the errors
  for (std::size_t k = 0; k < pulls.size(); ++k) {
    with_errors.middleCols<3>(3 * static_cast<Eigen::Index>(k)).noalias() =
        with(pulls[k].visit) * pulls[k].by_visit.transpose() +
        with_newest_ * pulls[k].by_newest.transpose();
  }
  Stack covariance(size, size);
  Stack information = Stack::Zero(size, size);
  StackVector error(size);
  for (std::size_t k = 0; k < pulls.size(); ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    covariance.middleRows<3>(row) =
        pulls[k].by_visit *
            with_errors.middleRows<3>(3 * static_cast<Eigen::Index>(pulls[k].visit)) +
        pulls[k].by_newest * with_errors.bottomRows<3>();
    information.block<3, 3>(row, row) = pulls[k].information;
    error.segment<3>(row) = pulls[k].error;
  }
  const Stack both = Stack::Identity(size, size) + information * covariance;
  const Eigen::PartialPivLU<Stack> solver(both);
  const StackVector weighted_error = information * error;
  const StackVector force = solver.solve(weighted_error);
  Pulled pulled;
  pulled.log_factor = -0.5 * error.dot(force) - 0.5 * std::log(std::abs(solver.determinant()));
  const Eigen::VectorXd shift = -(with_errors * force);
  pulled.poses.assign(poses_.begin(), poses_.end());
  pulled.poses.push_back(newest_);
  for (std::size_t i = 0; i < pulled.poses.size(); ++i) {
    Pose2& pose = pulled.poses[i];
    const Eigen::Vector3d by = shift.segment<3>(3 * static_cast<Eigen::Index>(i));
    pose = {pose.x + by.x(), pose.y + by.y(), wrap_angle(pose.theta + by.z())};
  }
  return pulled;
}

}  // namespace strata::topology
