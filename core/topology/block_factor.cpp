// SPDX-License-Identifier: Apache-2.0
#include "core/topology/block_factor.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace strata::topology {
namespace {

/// The blocks of A by rows.
struct Rows {
  std::vector<std::size_t> begin;
  std::vector<std::size_t> blocks;

  [[nodiscard]] std::span<const std::size_t> of(int row) const {
    const auto r = static_cast<std::size_t>(row);
    return std::span(blocks).subspan(begin[r], begin[r + 1] - begin[r]);
  }
};

Rows sorted_by_row(int size, std::span<const Block> blocks) {
  Rows rows{std::vector<std::size_t>(static_cast<std::size_t>(size) + 1, 0),
            std::vector<std::size_t>(blocks.size())};
  for (const Block& block : blocks) ++rows.begin[static_cast<std::size_t>(block.row) + 1];
  for (std::size_t r = 1; r < rows.begin.size(); ++r) rows.begin[r] += rows.begin[r - 1];
  std::vector<std::size_t> next = rows.begin;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    rows.blocks[next[static_cast<std::size_t>(blocks[b].row)]++] = b;
  }
  return rows;
}

/// Which columns of L each row has entries in, ascending: the row's blocks and all their ancestors
/// in the elimination tree below the row.
std::vector<std::vector<int>> fill_of_rows(int size, std::span<const Block> blocks,
                                           const Rows& rows) {
  std::vector<int> parent(static_cast<std::size_t>(size), -1);
  std::vector<int> seen_by(static_cast<std::size_t>(size), -1);
  std::vector<std::vector<int>> fill(static_cast<std::size_t>(size));
  for (int row = 0; row < size; ++row) {
    seen_by[static_cast<std::size_t>(row)] = row;
    std::vector<int>& columns = fill[static_cast<std::size_t>(row)];
    for (const std::size_t b : rows.of(row)) {
      for (int column = blocks[b].column; seen_by[static_cast<std::size_t>(column)] != row;) {
        seen_by[static_cast<std::size_t>(column)] = row;
        columns.push_back(column);
        int& up = parent[static_cast<std::size_t>(column)];
        if (up < 0) up = row;
        column = up;
      }
    }
    std::sort(columns.begin(), columns.end());
  }
  return fill;
}

/// The inverse of the lower triangular factor of a block; false when it is not positive definite.
bool invert_factor(const Eigen::Matrix3d& block, Eigen::Matrix3d& inverse) {
  const Eigen::LLT<Eigen::Matrix3d> factor(block);
  if (factor.info() != Eigen::Success) return false;
  inverse = factor.matrixL().solve(Eigen::Matrix3d::Identity());
  return inverse.allFinite();
}

}  // namespace

/// Row after row of L, each from the rows above it.
std::unique_ptr<const BlockFactor> BlockFactor::of(int size, std::span<const Block> blocks) {
  const Rows rows = sorted_by_row(size, blocks);
  const std::vector<std::vector<int>> fill = fill_of_rows(size, blocks, rows);
  const auto count = static_cast<std::size_t>(size);
  std::unique_ptr<BlockFactor> factor(new BlockFactor);
  factor->begin_.assign(count + 1, 0);
  for (const std::vector<int>& columns : fill) {
    for (const int column : columns) ++factor->begin_[static_cast<std::size_t>(column) + 1];
  }
  for (std::size_t c = 1; c <= count; ++c) factor->begin_[c] += factor->begin_[c - 1];
  factor->entries_.resize(factor->begin_.back());
  factor->inverse_diagonal_.resize(count);
  std::vector<std::size_t> end = factor->begin_;  // of what is known of each column
  std::vector<PaddedBlock> left(count, PaddedBlock{});
  for (std::size_t row = 0; row < count; ++row) {
    for (const std::size_t b : rows.of(static_cast<int>(row))) {
      block_in(left[static_cast<std::size_t>(blocks[b].column)]) += blocks[b].value;
    }
    for (const int fill_column : fill[row]) {
      const auto column = static_cast<std::size_t>(fill_column);
      PaddedBlock padded{};
      block_in(padded).noalias() =
          block_in(left[column]) * factor->inverse_diagonal_[column].transpose();
      const Eigen::Matrix3d entry = block_in(padded);
      left[column].fill(0.0);
      const std::size_t begin = factor->begin_[column];
      factor->entries_[end[column]++] = {static_cast<int>(row), entry};
      subtract_products(padded, std::span(factor->entries_).subspan(begin, end[column] - begin),
                        left.data());
    }
    if (!invert_factor(block_in(left[row]), factor->inverse_diagonal_[row])) return nullptr;
    left[row].fill(0.0);
  }
  return factor;
}

void BlockFactor::solve(Eigen::VectorXd& b) const {
  std::vector<Eigen::Vector3d> x(inverse_diagonal_.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = b.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  for (std::size_t c = 0; c < x.size(); ++c) {
    x[c] = (inverse_diagonal_[c] * x[c]).eval();
    for (const FactorEntry& entry : column(c)) {
      x[static_cast<std::size_t>(entry.row)].noalias() -= entry.value * x[c];
    }
  }
  for (std::size_t c = x.size(); c-- > 0;) {
    Eigen::Vector3d sum = x[c];
    for (const FactorEntry& entry : column(c)) {
      sum.noalias() -= entry.value.transpose() * x[static_cast<std::size_t>(entry.row)];
    }
    x[c].noalias() = inverse_diagonal_[c].transpose() * sum;
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
    if (begin_[c] == begin_[c + 1]) return ancestors;
    c = static_cast<std::size_t>(entries_[begin_[c]].row);
  }
}

Eigen::MatrixX3d BlockFactor::inverse_of(int row) const {
  const std::vector<std::size_t> ancestors = ancestors_of(row);
  std::vector<PaddedBlock> x(inverse_diagonal_.size(), PaddedBlock{});
  const auto at = [&](std::size_t c) { return block_in(x[c]); };
  at(static_cast<std::size_t>(row)).setIdentity();
  for (const std::size_t c : ancestors) {
    at(c) = (inverse_diagonal_[c] * at(c)).eval();
    for (const FactorEntry& entry : column(c)) {
      at(static_cast<std::size_t>(entry.row)).noalias() -= entry.value * at(c);
    }
  }
  for (const std::size_t c : ancestors) at(c).transposeInPlace();
  Eigen::MatrixX3d columns(3 * static_cast<Eigen::Index>(x.size()), 3);
  for (std::size_t c = x.size(); c-- > 0;) {
    subtract_transposed(column(c), x.data(), x[c]);
    const Eigen::Matrix3d sum = at(c).transpose();
    const Eigen::Matrix3d solved = inverse_diagonal_[c].transpose() * sum;
    at(c) = solved.transpose();
    columns.middleRows<3>(3 * static_cast<Eigen::Index>(c)) = solved;
  }
  return columns;
}

/// As inverse_of, of the ancestors alone.
Eigen::Matrix3d BlockFactor::inverse_block(int row) const {
  const std::vector<std::size_t> ancestors = ancestors_of(row);
  std::vector<Eigen::Matrix3d> x(ancestors.size(), Eigen::Matrix3d::Zero());
  x.front().setIdentity();
  // Rows ascend in each column, as ancestors do: one way through both finds each entry's row.
  const auto for_entries = [&](std::size_t i, const auto& use) {
    std::size_t at = i + 1;
    for (const FactorEntry& entry : column(ancestors[i])) {
      while (ancestors[at] != static_cast<std::size_t>(entry.row)) ++at;
      use(entry.value, x[at]);
    }
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = (inverse_diagonal_[ancestors[i]] * x[i]).eval();
    for_entries(i, [&](const Eigen::Matrix3d& entry, Eigen::Matrix3d& below) {
      below.noalias() -= entry * x[i];
    });
  }
  for (std::size_t i = x.size(); i-- > 0;) {
    Eigen::Matrix3d sum = x[i];
    for_entries(i, [&](const Eigen::Matrix3d& entry, const Eigen::Matrix3d& below) {
      sum.noalias() -= entry.transpose() * below;
    });
    x[i].noalias() = inverse_diagonal_[ancestors[i]].transpose() * sum;
  }
  return x.front();
}

double BlockFactor::log_determinant() const {
  double log_determinant = 0.0;
  for (const Eigen::Matrix3d& inverse : inverse_diagonal_) {
    log_determinant -= 2.0 * inverse.diagonal().array().log().sum();
  }
  return log_determinant;
}

}  // namespace strata::topology
