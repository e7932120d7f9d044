// SPDX-License-Identifier: Apache-2.0
#include "core/topology/block_pattern.hpp"

#include <algorithm>

namespace strata::topology {
namespace {

/// The columns of the matrix's blocks by rows.
struct Rows {
  std::vector<std::size_t> begin;
  std::vector<int> columns;

  [[nodiscard]] std::span<const int> of(std::size_t row) const {
    return std::span(columns).subspan(begin[row], begin[row + 1] - begin[row]);
  }
};

Rows sorted_by_row(std::size_t size, std::span<const std::pair<int, int>> touching) {
  Rows rows{std::vector<std::size_t>(size + 1, 0), std::vector<int>(touching.size())};
  for (const auto& [row, column] : touching) ++rows.begin[static_cast<std::size_t>(row) + 1];
  for (std::size_t r = 1; r < rows.begin.size(); ++r) rows.begin[r] += rows.begin[r - 1];
  std::vector<std::size_t> next = rows.begin;
  for (const auto& [row, column] : touching) {
    rows.columns[next[static_cast<std::size_t>(row)]++] = column;
  }
  return rows;
}

/// Calls fill(row, column) for every block of the factor, rows ascending: a row has the columns of
/// its own blocks and all their ancestors in the elimination tree below the row. parent: the tree,
/// -1 where it is not known yet.
template <typename Fill>
void for_fill(const Rows& rows, std::vector<int>& parent, Fill&& fill) {
  std::vector<int> seen_by(parent.size(), -1);
  for (std::size_t r = 0; r < parent.size(); ++r) {
    const auto row = static_cast<int>(r);
    seen_by[r] = row;
    for (int column : rows.of(r)) {
      while (seen_by[static_cast<std::size_t>(column)] != row) {
        const auto c = static_cast<std::size_t>(column);
        seen_by[c] = row;
        fill(row, c);
        if (parent[c] < 0) parent[c] = row;
        column = parent[c];
      }
    }
  }
}

}  // namespace

BlockPattern::BlockPattern(int size, std::span<const std::pair<int, int>> touching)
    : begin_(static_cast<std::size_t>(size) + 1, 0) {
  const Rows rows = sorted_by_row(static_cast<std::size_t>(size), touching);
  std::vector<int> parent(static_cast<std::size_t>(size), -1);
  for_fill(rows, parent, [&](int, std::size_t column) { ++begin_[column + 1]; });
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  rows_.resize(begin_.back());
  std::vector<std::size_t> next = begin_;
  for_fill(rows, parent, [&](int row, std::size_t column) { rows_[next[column]++] = row; });
}

std::size_t BlockPattern::position(int row, int column) const {
  const std::span<const int> column_rows = rows(static_cast<std::size_t>(column));
  const auto found = std::lower_bound(column_rows.begin(), column_rows.end(), row);
  return begin(static_cast<std::size_t>(column)) +
         static_cast<std::size_t>(found - column_rows.begin());
}

BlockMatrix::BlockMatrix(BlockPattern where)
    : pattern(std::move(where)),
      diagonal(static_cast<std::size_t>(pattern.size()), PaddedBlock{}),
      below(pattern.blocks(), PaddedBlock{}) {}

void BlockMatrix::add(int row, int column, const Eigen::Matrix3d& block) {
  PaddedBlock& to = row == column ? diagonal[static_cast<std::size_t>(row)]
                                  : below[pattern.position(row, column)];
  block_in(to) += block;
}

}  // namespace strata::topology
