// SPDX-License-Identifier: Apache-2.0
#include "core/topology/block_factor.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/core/topology/random_block.hpp"

namespace strata::topology {
namespace {

/// A chain with loops, as blocks J' J of random edges, some of them twice.
std::vector<Block> chain_with_loops(int size, int loops, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 77);
  std::vector<Block> blocks;
  const auto tie = [&](int a, int b) {
    const Eigen::Matrix3d by_a = test::random_block(random);
    const Eigen::Matrix3d by_b = test::random_block(random);
    blocks.push_back({a, a, by_a.transpose() * by_a});
    blocks.push_back({b, b, by_b.transpose() * by_b});
    blocks.push_back({std::max(a, b), std::min(a, b),
                      a > b ? Eigen::Matrix3d(by_a.transpose() * by_b)
                            : Eigen::Matrix3d(by_b.transpose() * by_a)});
  };
  for (int i = 0; i < size; ++i) blocks.push_back({i, i, 0.1 * Eigen::Matrix3d::Identity()});
  for (int i = 0; i + 1 < size; ++i) tie(i, i + 1);
  for (int i = 0; i < loops; ++i) {
    const int a = static_cast<int>(random.uniform() * size);
    const int b = static_cast<int>(random.uniform() * size);
    if (a == b) continue;
    tie(a, b);
    if (i % 3 == 0) tie(b, a);
  }
  return blocks;
}

Eigen::MatrixXd dense(int size, const std::vector<Block>& blocks) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(3 * size, 3 * size);
  for (const Block& block : blocks) {
    whole.block<3, 3>(3 * block.row, 3 * block.column) += block.value;
    if (block.row == block.column) continue;
    whole.block<3, 3>(3 * block.column, 3 * block.row) += block.value.transpose();
  }
  return whole;
}

TEST(BlockFactor, SolvesAsADenseFactorDoes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const int size = 1 + static_cast<int>(seed) * 2;
    const std::vector<Block> blocks = chain_with_loops(size, size / 2, seed);
    const Eigen::MatrixXd whole = dense(size, blocks);
    const auto factor = BlockFactor::of(size, blocks);
    ASSERT_NE(factor, nullptr);
    EXPECT_EQ(factor->size(), size);
    const Eigen::MatrixXd inverse = whole.inverse();
    for (int row = 0; row < size; ++row) {
      const Eigen::MatrixXd expected = inverse.middleCols<3>(3 * row);
      EXPECT_LT((factor->inverse_of(row) - expected).norm(), 1e-8 * inverse.norm());
    }
    Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * size, -1.0, 2.0);
    const Eigen::VectorXd expected = inverse * b;
    factor->solve(b);
    EXPECT_LT((b - expected).norm(), 1e-8 * inverse.norm());
    const Eigen::VectorXd pivots = whole.ldlt().vectorD();
    EXPECT_NEAR(factor->log_determinant(), pivots.array().log().sum(), 1e-8 * 3 * size);
  }
}

TEST(BlockFactor, OneBlockOfTheInverseIsTheSameBitsAlone) {
  for (const int loops : {0, 3, 40}) {
    const auto factor = BlockFactor::of(40, chain_with_loops(40, loops, 5));
    ASSERT_NE(factor, nullptr);
    for (int column = 0; column < 40; ++column) {
      const Eigen::MatrixX3d columns = factor->inverse_of(column);
      for (int row = 0; row < 40; ++row) {
        const Eigen::Matrix3d block = columns.block<3, 3>(3 * row, 0);
        EXPECT_EQ(factor->inverse_block(row, column), block) << row << ' ' << column;
      }
    }
  }
}

TEST(BlockFactor, IsNoneOfAMatrixThatIsNotPositiveDefinite) {
  std::vector<Block> blocks = chain_with_loops(12, 4, 3);
  ASSERT_NE(BlockFactor::of(12, blocks), nullptr);
  blocks.push_back({7, 7, -100.0 * Eigen::Matrix3d::Identity()});
  EXPECT_EQ(BlockFactor::of(12, blocks), nullptr);
  blocks.back().value.setConstant(std::nan(""));
  EXPECT_EQ(BlockFactor::of(12, blocks), nullptr);
}

}  // namespace
}  // namespace strata::topology
