// SPDX-License-Identifier: Apache-2.0
/// Products of 3 x 3 blocks, many with one: the same bits on every SIMD target, and those of Eigen
/// with two lanes, which sums the products of a third row in another order.
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

/// A block of a column of a sparse factor.
struct FactorEntry {
  int row = 0;
  Eigen::Matrix3d value;
};

/// left[e.row] -= block * e.value' for every entry.
void subtract_products(const PaddedBlock& block, std::span<const FactorEntry> entries,
                       PaddedBlock* left);

/// sum' -= the sum of e.value' * x[e.row]' over the entries, one after the other: blocks are held
/// transposed.
void subtract_transposed(std::span<const FactorEntry> entries, const PaddedBlock* x,
                         PaddedBlock& sum);

}  // namespace strata::topology
