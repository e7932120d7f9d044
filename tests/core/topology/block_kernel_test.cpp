// SPDX-License-Identifier: Apache-2.0
#include "core/topology/block_kernel.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/core/topology/random_block.hpp"
#include "tests/support/every_target.hpp"

namespace strata::topology {
namespace {

PaddedBlock padded(const Eigen::Matrix3d& block) {
  PaddedBlock result{};
  block_in(result) = block;
  return result;
}

std::vector<PaddedBlock> random_blocks(RandomStream& random, std::size_t count) {
  std::vector<PaddedBlock> blocks;
  for (std::size_t i = 0; i < count; ++i) blocks.push_back(padded(test::random_block(random)));
  return blocks;
}

/// a b', each sum from left to right.
Eigen::Matrix3d product(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  Eigen::Matrix3d result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      result(i, j) = (a(i, 0) * b(j, 0) + a(i, 1) * b(j, 1)) + a(i, 2) * b(j, 2);
    }
  }
  return result;
}

/// Rows 1, 2 and 4 of column 0; what they fill in in columns 1 and 2, and a row 3 beside it.
TEST(BlockKernel, EliminatesAColumnWithTheSameBitsOnEveryTarget) {
  const std::vector<std::size_t> begin{0, 3, 6, 7, 7, 7};
  const std::vector<int> rows{1, 2, 4, 2, 3, 4, 4};
  RandomStream random(1, StreamId::kTest, 81);
  for (int n = 0; n < 50; ++n) {
    const std::vector<PaddedBlock> diagonal = random_blocks(random, 5);
    const std::vector<PaddedBlock> below = random_blocks(random, rows.size());
    Eigen::Matrix3d inverse = test::random_block(random);
    inverse.triangularView<Eigen::StrictlyUpper>().setZero();
    std::vector<PaddedBlock> expected_diagonal = diagonal;
    std::vector<PaddedBlock> expected = below;
    for (const std::size_t i : {0, 1, 2}) {
      block_in(expected[i]) = product(block_in(below[i]), inverse);
      const auto row = static_cast<std::size_t>(rows[i]);
      block_in(expected_diagonal[row]) -= product(block_in(expected[i]), block_in(expected[i]));
    }
    block_in(expected[3]) -= product(block_in(expected[1]), block_in(expected[0]));
    block_in(expected[5]) -= product(block_in(expected[2]), block_in(expected[0]));
    block_in(expected[6]) -= product(block_in(expected[2]), block_in(expected[1]));
    test::for_every_target([&] {
      std::vector<PaddedBlock> own_diagonal = diagonal;
      std::vector<PaddedBlock> own = below;
      eliminate_column(0, padded(inverse), {begin.data(), rows.data()}, own_diagonal.data(),
                       own.data());
      for (std::size_t i = 0; i < own.size(); ++i) {
        EXPECT_EQ(Eigen::Matrix3d(block_in(own[i])), Eigen::Matrix3d(block_in(expected[i]))) << i;
      }
      for (std::size_t i = 0; i < own_diagonal.size(); ++i) {
        EXPECT_EQ(Eigen::Matrix3d(block_in(own_diagonal[i])),
                  Eigen::Matrix3d(block_in(expected_diagonal[i])))
            << i;
      }
    });
  }
}

TEST(BlockKernel, SubtractsTransposedProductsWithTheSameBitsOnEveryTarget) {
  const std::vector<int> rows{1, 2, 5, 7};
  RandomStream random(2, StreamId::kTest, 81);
  for (int n = 0; n < 50; ++n) {
    const std::vector<PaddedBlock> blocks = random_blocks(random, rows.size());
    const std::vector<PaddedBlock> all_x = random_blocks(random, 8);
    Eigen::Matrix3d expected = block_in(all_x[0]).transpose();
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Eigen::Matrix3d x = block_in(all_x[static_cast<std::size_t>(rows[k])]).transpose();
      const Eigen::Matrix3d block = block_in(blocks[k]);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          expected(i, j) -= (block(0, i) * x(0, j) + block(1, i) * x(1, j)) + block(2, i) * x(2, j);
        }
      }
    }
    test::for_every_target([&] {
      PaddedBlock sum = all_x[0];
      subtract_transposed(rows, blocks.data(), all_x.data(), sum);
      EXPECT_EQ(Eigen::Matrix3d(block_in(sum).transpose()), expected);
    });
  }
}

}  // namespace
}  // namespace strata::topology
