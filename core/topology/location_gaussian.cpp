// SPDX-License-Identifier: Apache-2.0
#include "core/topology/location_gaussian.hpp"

#include <cmath>

namespace strata::topology {

Eigen::MatrixX3d LocationGaussian::covariance_with(std::size_t visit) const {
  Eigen::MatrixX3d covariances = Eigen::MatrixX3d::Zero(3 * static_cast<Eigen::Index>(visits()), 3);
  if (!factor_ || visit == 0) return covariances;
  Eigen::MatrixX3d unit = Eigen::MatrixX3d::Zero(factor_->rows(), 3);
  unit.block<3, 3>(rows_[visit], 0).setIdentity();
  const Eigen::MatrixX3d solved = factor_->solve(unit);
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    covariances.block<3, 3>(3 * static_cast<Eigen::Index>(i), 0) = solved.block<3, 3>(rows_[i], 0);
  }
  return covariances;
}

double LocationGaussian::log_determinant() const {
  if (!factor_) return 0.0;
  const Eigen::SparseMatrix<double>& lower = factor_->matrixL().nestedExpression();
  double log_determinant = 0.0;
  for (Eigen::Index column = 0; column < lower.cols(); ++column) {
    // The diagonal comes first in its column.
    log_determinant += 2.0 * std::log(lower.valuePtr()[lower.outerIndexPtr()[column]]);
  }
  return log_determinant;
}

}  // namespace strata::topology
