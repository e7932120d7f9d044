// SPDX-License-Identifier: Apache-2.0
#include "core/topology/block_factor.hpp"

#include <cmath>
#include <utility>

namespace strata::topology {
namespace {

/// Replaces a block by the inverse of its lower triangular factor; false when it is not positive
/// definite.
bool invert_factor(PaddedBlock& padded) {
  PaddedMap block = block_in(padded);
  const double aa = std::sqrt(block(0, 0));
  const double ba = block(1, 0) / aa;
  const double ca = block(2, 0) / aa;
  const double bb = std::sqrt(block(1, 1) - ba * ba);
  const double cb = (block(2, 1) - ca * ba) / bb;
  const double cc = std::sqrt(block(2, 2) - ca * ca - cb * cb);
  // Roots of what is negative, and all that is not a number, fail these.
  if (!(aa > 0.0 && bb > 0.0 && cc > 0.0)) return false;
  const double a = 1.0 / aa;
  const double b = 1.0 / bb;
  const double c = 1.0 / cc;
  const double below = -ba * a * b;
  block << a, 0.0, 0.0, below, b, 0.0, -(ca * a + cb * below) * c, -cb * b * c, c;
  return block.allFinite();
}

}  // namespace

BlockFactor::BlockFactor(BlockMatrix matrix)
    : pattern_(std::move(matrix.pattern)),
      blocks_(std::move(matrix.below)),
      inverse_diagonal_(std::move(matrix.diagonal)) {}

/// Column after column, in place: what each leaves of the ones behind it.
std::unique_ptr<const BlockFactor> BlockFactor::of(BlockMatrix matrix) {
  const ColumnStarts starts = matrix.pattern.starts();
  for (std::size_t c = 0; c < matrix.diagonal.size(); ++c) {
    if (!invert_factor(matrix.diagonal[c])) return nullptr;
    eliminate_column(c, matrix.diagonal[c], starts, matrix.diagonal.data(), matrix.below.data());
  }
  return std::unique_ptr<const BlockFactor>(new BlockFactor(std::move(matrix)));
}

std::unique_ptr<const BlockFactor> BlockFactor::of(int size, std::span<const Block> blocks) {
  std::vector<std::pair<int, int>> touching;
  for (const Block& block : blocks) {
    if (block.row > block.column) touching.emplace_back(block.row, block.column);
  }
  BlockMatrix matrix(BlockPattern(size, touching));
  for (const Block& block : blocks) matrix.add(block.row, block.column, block.value);
  return of(std::move(matrix));
}

void BlockFactor::solve(Eigen::VectorXd& b) const {
  std::vector<Eigen::Vector3d> x(inverse_diagonal_.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = b.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  for (std::size_t c = 0; c < x.size(); ++c) {
    x[c] = (block_in(inverse_diagonal_[c]) * x[c]).eval();
    const PaddedBlock* block = blocks_.data() + pattern_.begin(c);
    for (const int row : pattern_.rows(c)) {
      x[static_cast<std::size_t>(row)].noalias() -= block_in(*block++) * x[c];
    }
  }
  for (std::size_t c = x.size(); c-- > 0;) {
    Eigen::Vector3d sum = x[c];
    const PaddedBlock* block = blocks_.data() + pattern_.begin(c);
    for (const int row : pattern_.rows(c)) {
      sum.noalias() -= block_in(*block++).transpose() * x[static_cast<std::size_t>(row)];
    }
    x[c].noalias() = block_in(inverse_diagonal_[c]).transpose() * sum;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    b.segment<3>(3 * static_cast<Eigen::Index>(i)) = x[i];
  }
}

/// With the row, ascending: its way up the elimination tree. All entries of their columns are among
/// them, so a right side that is zero but in `row` stays zero elsewhere, and what comes back to
/// `row` comes from them alone.
std::vector<std::size_t> BlockFactor::ancestors_of(int row) const {
  std::vector<std::size_t> ancestors;
  for (auto c = static_cast<std::size_t>(row);;) {
    ancestors.push_back(c);
    const std::span<const int> rows = pattern_.rows(c);
    if (rows.empty()) return ancestors;
    c = static_cast<std::size_t>(rows.front());
  }
}

Eigen::MatrixX3d BlockFactor::inverse_of(int row) const {
  const std::vector<std::size_t> ancestors = ancestors_of(row);
  std::vector<PaddedBlock> x(inverse_diagonal_.size(), PaddedBlock{});
  const auto at = [&](std::size_t c) { return block_in(x[c]); };
  at(static_cast<std::size_t>(row)).setIdentity();
  for (const std::size_t c : ancestors) {
    at(c) = (block_in(inverse_diagonal_[c]) * at(c)).eval();
    const PaddedBlock* block = blocks_.data() + pattern_.begin(c);
    for (const int below : pattern_.rows(c)) {
      at(static_cast<std::size_t>(below)).noalias() -= block_in(*block++) * at(c);
    }
  }
  for (const std::size_t c : ancestors) at(c).transposeInPlace();
  Eigen::MatrixX3d columns(3 * static_cast<Eigen::Index>(x.size()), 3);
  for (std::size_t c = x.size(); c-- > 0;) {
    subtract_transposed(pattern_.rows(c), blocks_.data() + pattern_.begin(c), x.data(), x[c]);
    const Eigen::Matrix3d sum = at(c).transpose();
    const Eigen::Matrix3d solved = block_in(inverse_diagonal_[c]).transpose() * sum;
    at(c) = solved.transpose();
    columns.middleRows<3>(3 * static_cast<Eigen::Index>(c)) = solved;
  }
  return columns;
}

/// As inverse_of, of the ancestors alone: down those of the column, and back up those of the row.
Eigen::Matrix3d BlockFactor::inverse_block(int row, int column) const {
  // Rows ascend in each column, as ancestors do: one way through both finds each block's row.
  const auto for_blocks = [&](const std::vector<std::size_t>& ancestors, std::size_t i,
                              const auto& use) {
    std::size_t at = i + 1;
    const PaddedBlock* block = blocks_.data() + pattern_.begin(ancestors[i]);
    for (const int below : pattern_.rows(ancestors[i])) {
      while (ancestors[at] != static_cast<std::size_t>(below)) ++at;
      use(block_in(*block++), at);
    }
  };
  const std::vector<std::size_t> down = ancestors_of(column);
  std::vector<Eigen::Matrix3d> y(down.size(), Eigen::Matrix3d::Zero());
  y.front().setIdentity();
  for (std::size_t i = 0; i < y.size(); ++i) {
    y[i] = (block_in(inverse_diagonal_[down[i]]) * y[i]).eval();
    for_blocks(down, i, [&](const ConstPaddedMap& block, std::size_t below) {
      y[below].noalias() -= block * y[i];
    });
  }
  const std::vector<std::size_t> up = row == column ? down : ancestors_of(row);
  std::vector<Eigen::Matrix3d> x(up.size(), Eigen::Matrix3d::Zero());
  // From where the two ways meet they are one.
  for (std::size_t i = up.size(), k = down.size(); i > 0 && k > 0 && up[i - 1] == down[k - 1];) {
    x[--i] = y[--k];
  }
  for (std::size_t i = x.size(); i-- > 0;) {
    Eigen::Matrix3d sum = x[i];
    for_blocks(up, i, [&](const ConstPaddedMap& block, std::size_t below) {
      sum.noalias() -= block.transpose() * x[below];
    });
    x[i].noalias() = block_in(inverse_diagonal_[up[i]]).transpose() * sum;
  }
  return x.front();
}

double BlockFactor::log_determinant() const {
  double log_determinant = 0.0;
  for (const PaddedBlock& inverse : inverse_diagonal_) {
    log_determinant -= 2.0 * block_in(inverse).diagonal().array().log().sum();
  }
  return log_determinant;
}

}  // namespace strata::topology
