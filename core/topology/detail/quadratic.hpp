// SPDX-License-Identifier: Apache-2.0
/// Gradient and curvature of the cost of one topology.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/topology/block_factor.hpp"
#include "core/topology/detail/terms.hpp"

namespace strata::topology::detail {

/// What of the curvature counts.
enum class Curvature {
  kGaussian,  ///< of links the squared slopes; of penalties all
  kExact,     ///< all, also how links bend by which they are off
  kRoots,     ///< as kGaussian, of penalties the squared slopes of their roots: never indefinite
  kPositive,  ///< as kGaussian, of penalties only what bends up: never indefinite
  kLinks,     ///< as kGaussian, without penalties
};

/// Gradient and curvature of the cost by all poses but the first.
class Quadratic {
 public:
  /// rows: of each visit; pattern: nothing for the gradient alone.
  Quadratic(const std::vector<int>& rows, std::optional<BlockPattern> pattern)
      : rows_(rows),
        gradient_(Eigen::VectorXd::Zero(3 * (static_cast<Eigen::Index>(rows.size()) - 1))),
        diagonal_(gradient_) {
    if (pattern) matrix_.emplace(std::move(*pattern));
  }
  [[nodiscard]] bool with_curvature() const { return matrix_.has_value(); }
  void add_gradient(std::size_t visit, const Eigen::Vector3d& by_pose) {
    if (visit > 0) gradient_.segment<3>(3 * static_cast<Eigen::Index>(rows_[visit])) += by_pose;
  }
  void add(std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
    if (a == 0 || b == 0 || rows_[a] < rows_[b]) return;
    if (a == b) diagonal_.segment<3>(3 * static_cast<Eigen::Index>(rows_[a])) += block.diagonal();
    matrix_->add(rows_[a], rows_[b], block);
  }
  /// Adds a share of the diagonal to itself, which makes steps shorter.
  void damp(double share) {
    const Eigen::VectorXd added = share * diagonal_;
    for (std::size_t visit = 1; visit < rows_.size(); ++visit) {
      const auto row = 3 * static_cast<Eigen::Index>(rows_[visit]);
      add(visit, visit, added.segment<3>(row).asDiagonal());
    }
  }
  /// Of the two positions: +block on their own, -block between them. block: symmetric.
  void add_apart(const Pair& pair, const Eigen::Matrix2d& block) {
    Eigen::Matrix3d whole = Eigen::Matrix3d::Zero();
    whole.topLeftCorner<2, 2>() = block;
    add(pair.a, pair.a, whole);
    add(pair.b, pair.b, whole);
    add(pair.a, pair.b, -whole);
    add(pair.b, pair.a, -whole);
  }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// The curvature is gone then.
  [[nodiscard]] std::unique_ptr<const BlockFactor> factorize() {
    return BlockFactor::of(std::move(*matrix_));
  }

 private:
  const std::vector<int>& rows_;
  std::optional<BlockMatrix> matrix_;
  Eigen::VectorXd gradient_;
  Eigen::VectorXd diagonal_;  // of the curvature
};

/// near: of the terms' landmarks within the penalty's radius; rows: of each visit.
[[nodiscard]] Quadratic quadratic_at(const Terms& terms, const LocationPriorConfig& config,
                                     std::span<const Pose2> poses, const std::vector<int>& rows,
                                     Curvature curvature, NearPairs& near);
/// The gradient of the same alone.
[[nodiscard]] Eigen::VectorXd gradient_at(const Terms& terms, const LocationPriorConfig& config,
                                          std::span<const Pose2> poses,
                                          const std::vector<int>& rows, NearPairs& near);

}  // namespace strata::topology::detail
