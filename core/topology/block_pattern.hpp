// SPDX-License-Identifier: Apache-2.0
/// Where a symmetric matrix of 3 x 3 blocks and its sparse factor have blocks that are not zero.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/topology/block_kernel.hpp"

namespace strata::topology {

/// A block on or below the diagonal.
struct Block {
  int row = 0;
  int column = 0;  ///< at most row
  Eigen::Matrix3d value;
};

/// Where the factor has blocks below the diagonal: those of the matrix and what elimination fills
/// in [davis2006direct, section 4.7]. Immutable.
class BlockPattern {
 public:
  BlockPattern() = default;
  /// touching: (row, column) of the matrix's blocks below the diagonal, in any order, some perhaps
  /// twice. O(blocks of the factor).
  BlockPattern(int size, std::span<const std::pair<int, int>> touching);

  [[nodiscard]] int size() const { return static_cast<int>(begin_.size()) - 1; }
  [[nodiscard]] std::size_t blocks() const { return rows_.size(); }
  /// Of the blocks of a column among all blocks.
  [[nodiscard]] std::size_t begin(std::size_t column) const { return begin_[column]; }
  [[nodiscard]] std::size_t end(std::size_t column) const { return begin_[column + 1]; }
  /// The rows of a column's blocks, ascending.
  [[nodiscard]] std::span<const int> rows(std::size_t column) const {
    return std::span(rows_).subspan(begin(column), end(column) - begin(column));
  }
  /// Of a block that is there. O(ln of the column's blocks).
  [[nodiscard]] std::size_t position(int row, int column) const;
  [[nodiscard]] ColumnStarts starts() const { return {begin_.data(), rows_.data()}; }

 private:
  std::vector<std::size_t> begin_{0};
  std::vector<int> rows_;
};

/// A symmetric matrix by its lower triangle, with room for its factor.
struct BlockMatrix {
  explicit BlockMatrix(BlockPattern where);
  /// Requires a block that the pattern has; of one on the diagonal only the lower triangle counts.
  void add(int row, int column, const Eigen::Matrix3d& block);

  BlockPattern pattern;
  std::vector<PaddedBlock> diagonal;
  std::vector<PaddedBlock> below;
};

}  // namespace strata::topology
