// SPDX-License-Identifier: Apache-2.0
#include "core/topology/location_gaussian.hpp"

namespace strata::topology {

Eigen::MatrixX3d LocationGaussian::covariance_with(std::size_t visit) const {
  Eigen::MatrixX3d covariances = Eigen::MatrixX3d::Zero(3 * static_cast<Eigen::Index>(visits()), 3);
  if (!factor_ || visit == 0) return covariances;
  const Eigen::MatrixX3d solved = factor_->inverse_of(rows_[visit]);
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    covariances.block<3, 3>(3 * static_cast<Eigen::Index>(i), 0) =
        solved.block<3, 3>(3 * static_cast<Eigen::Index>(rows_[i]), 0);
  }
  return covariances;
}

Eigen::Matrix3d LocationGaussian::covariance_between(std::size_t visit, std::size_t other) const {
  if (!factor_ || visit == 0 || other == 0) return Eigen::Matrix3d::Zero();
  return factor_->inverse_block(rows_[visit], rows_[other]);
}

Eigen::VectorXd LocationGaussian::moved_by(
    std::span<const std::pair<std::size_t, Eigen::Vector3d>> forces) const {
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(visits()));
  if (!factor_) return moved;
  Eigen::VectorXd by_row = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(factor_->size()));
  for (const auto& [visit, force] : forces) {
    if (visit > 0) by_row.segment<3>(3 * static_cast<Eigen::Index>(rows_[visit])) += force;
  }
  factor_->solve(by_row);
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    moved.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        by_row.segment<3>(3 * static_cast<Eigen::Index>(rows_[i]));
  }
  return moved;
}

double LocationGaussian::log_determinant() const {
  return factor_ ? factor_->log_determinant() : 0.0;
}

}  // namespace strata::topology
