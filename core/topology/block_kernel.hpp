// SPDX-License-Identifier: Apache-2.0
/// Products of 3 x 3 blocks, many with one: the same bits on every SIMD target.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace strata::topology {

/// A block with room for whole vectors: three columns of three rows and a fourth that is no part
/// of it.
using PaddedBlock = std::array<double, 12>;
using PaddedMap = Eigen::Map<Eigen::Matrix3d, Eigen::Unaligned, Eigen::OuterStride<4>>;
using ConstPaddedMap = Eigen::Map<const Eigen::Matrix3d, Eigen::Unaligned, Eigen::OuterStride<4>>;
[[nodiscard]] inline PaddedMap block_in(PaddedBlock& padded) {
  return PaddedMap(padded.data(), Eigen::OuterStride<4>());
}
[[nodiscard]] inline ConstPaddedMap block_in(const PaddedBlock& padded) {
  return ConstPaddedMap(padded.data(), Eigen::OuterStride<4>());
}

/// Of a matrix by columns: where the blocks of each column begin, and the row of every block.
struct ColumnStarts {
  const std::size_t* begin = nullptr;
  const int* rows = nullptr;
};

/// One step of a Cholesky factor by columns: the blocks of `column` times inverse', and then from
/// every two of them, at rows i >= k, left(i, k) -= block_i * block_k'. inverse: lower triangular.
/// diagonal, below: of the whole matrix. Requires every row pair of the column in the matrix.
void eliminate_column(std::size_t column, const PaddedBlock& inverse, const ColumnStarts& starts,
                      PaddedBlock* diagonal, PaddedBlock* below);

/// sum' -= the sum of block' * x[row]' over the blocks, one after the other: x and sum are held
/// transposed. rows: one a block.
void subtract_transposed(std::span<const int> rows, const PaddedBlock* blocks, const PaddedBlock* x,
                         PaddedBlock& sum);

}  // namespace strata::topology
