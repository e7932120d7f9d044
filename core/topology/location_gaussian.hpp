// SPDX-License-Identifier: Apache-2.0
/// The Gaussian over the poses of all visits that a particle carries [ranganathan2006rao, eq.
/// (11)].
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/topology/block_factor.hpp"

namespace strata::topology {

/// Zero-mean Gaussian over the errors of all poses but the first, which is certain, by the sparse
/// factor of its information. The errors are of (x, y, theta) in the map frame. Immutable.
class LocationGaussian {
 public:
  /// Of one visit: nothing is uncertain.
  LocationGaussian() = default;
  /// rows: of each visit in the factor; of the first one unused.
  LocationGaussian(std::unique_ptr<const BlockFactor> factor, std::vector<int> rows)
      : factor_(std::move(factor)), rows_(std::move(rows)) {}

  [[nodiscard]] std::size_t visits() const { return factor_ ? rows_.size() : 1; }
  /// Covariance of every visit's pose with that of `visit`: 3 visits() x 3. O(fill of the factor).
  [[nodiscard]] Eigen::MatrixX3d covariance_with(std::size_t visit) const;
  /// Covariance of one visit's pose: that block of covariance_with(visit). O(fill of the rows that
  /// it depends on).
  [[nodiscard]] Eigen::Matrix3d covariance_of(std::size_t visit) const {
    return covariance_between(visit, visit);
  }
  /// Covariance of the pose of `visit` with that of `other`: as covariance_of.
  [[nodiscard]] Eigen::Matrix3d covariance_between(std::size_t visit, std::size_t other) const;
  /// What forces on some poses, (visit, force), move each pose by: the covariance times them, 3
  /// rows a visit. O(fill of the factor).
  [[nodiscard]] Eigen::VectorXd moved_by(
      std::span<const std::pair<std::size_t, Eigen::Vector3d>> forces) const;
  /// Of each visit in the factor, to be taken over by the next one; empty for one visit.
  [[nodiscard]] const std::vector<int>& rows() const { return rows_; }
  /// ln of the determinant of the information.
  [[nodiscard]] double log_determinant() const;

 private:
  std::unique_ptr<const BlockFactor> factor_;
  std::vector<int> rows_;
};

/// The covariance of `visit` in what covariance_with(visit) gave, or of `other` with it.
[[nodiscard]] inline Eigen::Matrix3d block_of(const Eigen::MatrixX3d& covariances,
                                              std::size_t other) {
  return covariances.block<3, 3>(3 * static_cast<Eigen::Index>(other), 0);
}

}  // namespace strata::topology
