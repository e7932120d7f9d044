// SPDX-License-Identifier: Apache-2.0
#include "core/topology/block_kernel.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/core/topology/random_block.hpp"
#include "tests/support/every_target.hpp"

namespace strata::topology {
namespace {

struct Column {
  std::vector<FactorEntry> entries;  // some rows of eight
  std::vector<PaddedBlock> rows;
};

Column random_column(RandomStream& random) {
  Column column;
  for (const int row : {1, 2, 5, 7}) column.entries.push_back({row, test::random_block(random)});
  column.rows.resize(8, PaddedBlock{});
  for (PaddedBlock& row : column.rows) block_in(row) = test::random_block(random);
  return column;
}

TEST(BlockKernel, SubtractsProductsWithTheSameBitsOnEveryTarget) {
  RandomStream random(1, StreamId::kTest, 81);
  for (int n = 0; n < 50; ++n) {
    const Column column = random_column(random);
    PaddedBlock block{};
    block_in(block) = test::random_block(random);
    std::vector<Eigen::Matrix3d> expected;
    for (const PaddedBlock& row : column.rows) expected.emplace_back(block_in(row));
    for (const FactorEntry& entry : column.entries) {
      Eigen::Matrix3d& to = expected[static_cast<std::size_t>(entry.row)];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const double x = block_in(block)(i, 0) * entry.value(j, 0);
          const double y = block_in(block)(i, 1) * entry.value(j, 1);
          const double z = block_in(block)(i, 2) * entry.value(j, 2);
          to(i, j) -= i < 2 ? (x + y) + z : x + (y + z);
        }
      }
    }
    test::for_every_target([&] {
      std::vector<PaddedBlock> left = column.rows;
      subtract_products(block, column.entries, left.data());
      for (std::size_t row = 0; row < left.size(); ++row) {
        EXPECT_EQ(Eigen::Matrix3d(block_in(left[row])), expected[row]) << row;
      }
    });
  }
}

TEST(BlockKernel, SubtractsTransposedProductsWithTheSameBitsOnEveryTarget) {
  RandomStream random(2, StreamId::kTest, 81);
  for (int n = 0; n < 50; ++n) {
    const Column column = random_column(random);
    Eigen::Matrix3d expected = block_in(column.rows[0]).transpose();
    for (const FactorEntry& entry : column.entries) {
      const Eigen::Matrix3d x =
          block_in(column.rows[static_cast<std::size_t>(entry.row)]).transpose();
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          expected(i, j) -= (entry.value(0, i) * x(0, j) + entry.value(1, i) * x(1, j)) +
                            entry.value(2, i) * x(2, j);
        }
      }
    }
    test::for_every_target([&] {
      PaddedBlock sum = column.rows[0];
      subtract_transposed(column.entries, column.rows.data(), sum);
      EXPECT_EQ(Eigen::Matrix3d(block_in(sum).transpose()), expected);
    });
  }
}

}  // namespace
}  // namespace strata::topology
