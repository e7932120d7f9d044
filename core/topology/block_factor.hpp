// SPDX-License-Identifier: Apache-2.0
/// Sparse Cholesky factor of an information matrix whose entries are 3 x 3 blocks, one row a pose.
/// Eigen factors scalar by scalar: five times slower for a hundred poses, where an update factors a
/// hundred matrices.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/topology/block_kernel.hpp"
#include "core/topology/block_pattern.hpp"

namespace strata::topology {

/// The lower triangular L with L L' = A [davis2006direct, section 4.7, by blocks]. Immutable.
class BlockFactor {
 public:
  /// Null when A is not positive definite. O(fill^2 / size) about.
  [[nodiscard]] static std::unique_ptr<const BlockFactor> of(BlockMatrix matrix);
  /// The sum of the blocks is A: symmetric, of size x size blocks.
  [[nodiscard]] static std::unique_ptr<const BlockFactor> of(int size,
                                                             std::span<const Block> blocks);

  [[nodiscard]] int size() const { return pattern_.size(); }
  /// A^-1 b, in place; b: 3 size() rows. O(fill).
  void solve(Eigen::VectorXd& b) const;
  /// The three columns of A^-1 that belong to `row`: 3 size() x 3. O(fill).
  [[nodiscard]] Eigen::MatrixX3d inverse_of(int row) const;
  /// The block of A^-1 in that row and column. O(fill of the rows that it depends on), a few of a
  /// large matrix.
  [[nodiscard]] Eigen::Matrix3d inverse_block(int row, int column) const;
  /// ln of the determinant of A.
  [[nodiscard]] double log_determinant() const;

 private:
  explicit BlockFactor(BlockMatrix matrix);
  [[nodiscard]] std::vector<std::size_t> ancestors_of(int row) const;
  BlockPattern pattern_;
  std::vector<PaddedBlock> blocks_;            // below the diagonal, of each column
  std::vector<PaddedBlock> inverse_diagonal_;  // of L's blocks, lower triangular
};

}  // namespace strata::topology
