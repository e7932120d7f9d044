// SPDX-License-Identifier: Apache-2.0
#include "core/localization/block_bounds.hpp"

#include <algorithm>

#include "core/grid/floor_divide.hpp"
#include "core/localization/block_kernel.hpp"

namespace strata::localization {

BlockBounds::BlockBounds(const Grid<std::uint8_t>& scores, int levels) : side_(1 << levels) {
  maxima_.push_back({{0, 0}, scores.width(), scores.height(), scores.values()});
  for (int level = 1; level <= levels; ++level) {
    maxima_.push_back(widened(maxima_.back(), 1 << (level - 1)));
  }
  blocks_x_ = (scores.width() + side_ - 1) / side_;
  blocks_y_ = (scores.height() + side_ - 1) / side_;
  make_planes();
}

/// Maxima over squares twice as wide, each of four.
BlockBounds::Maxima BlockBounds::widened(const Maxima& maxima, int half) {
  Maxima wide{
      {maxima.min.x - half, maxima.min.y - half}, maxima.width + half, maxima.height + half, {}};
  wide.values.assign(static_cast<std::size_t>(wide.width) * static_cast<std::size_t>(wide.height),
                     0);
  const auto row = [](auto& values, int width, int y) {
    return values.data() + static_cast<std::ptrdiff_t>(y) * width;
  };
  for (int y = 0; y < maxima.height; ++y) {
    const std::uint8_t* from = row(maxima.values, maxima.width, y);
    std::uint8_t* to = row(wide.values, wide.width, y + half);
    for (int x = 0; x < maxima.width; ++x) {
      to[x + half] = std::max(to[x + half], from[x]);
      to[x] = std::max(to[x], from[x]);
    }
  }
  // Row y of the result takes rows y and y + half of those just made.
  for (int y = 0; y + half < wide.height; ++y) {
    std::uint8_t* to = row(wide.values, wide.width, y);
    const std::uint8_t* from = row(wide.values, wide.width, y + half);
    for (int x = 0; x < wide.width; ++x) to[x] = std::max(to[x], from[x]);
  }
  return wide;
}

void BlockBounds::make_planes() {
  const Maxima& top = maxima_.back();
  left_ = blocks_x_ + 1;
  stride_ =
      static_cast<std::size_t>(left_) + 1 + 2 * static_cast<std::size_t>(blocks_x_) + 1 + kSlack;
  plane_rows_ = blocks_y_ + 1;  // from block row -1
  plane_size_ = stride_ * static_cast<std::size_t>(plane_rows_);
  planes_.assign(plane_size_ * static_cast<std::size_t>(side_ * side_), 0);
  for (int y = 0; y < top.height; ++y) {
    const int v = y + top.min.y;
    const int block_y = floor_divide(v, side_);
    const int phase_y = v - block_y * side_;
    for (int x = 0; x < top.width; ++x) {
      const int u = x + top.min.x;
      const int block_x = floor_divide(u, side_);
      const int phase_x = u - block_x * side_;
      const std::size_t plane = static_cast<std::size_t>(phase_y * side_ + phase_x) * plane_size_;
      planes_[plane + static_cast<std::size_t>(block_y + 1) * stride_ +
              static_cast<std::size_t>(left_ + 1 + block_x)] =
          top.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(top.width) +
                     static_cast<std::size_t>(x)];
    }
  }
}

std::uint32_t BlockBounds::at(int level, const Cell& cell,
                              std::span<const CellOffset> offsets) const {
  const Maxima& maxima = maxima_[static_cast<std::size_t>(level)];
  const int x = cell.x - maxima.min.x;
  const int y = cell.y - maxima.min.y;
  const auto width = static_cast<std::uint32_t>(maxima.width);
  const auto height = static_cast<std::uint32_t>(maxima.height);
  const std::uint8_t* values = maxima.values.data();
  std::uint32_t sum = 0;
  for (const CellOffset& offset : offsets) {
    const auto u = static_cast<std::uint32_t>(x + offset.x);
    const auto v = static_cast<std::uint32_t>(y + offset.y);
    if (u < width && v < height) sum += values[static_cast<std::size_t>(v) * width + u];
  }
  return sum;
}

void BlockBounds::row_sums(int row, int begin, int end, std::span<const CellOffset> offsets,
                           std::vector<const std::uint8_t*>& rows, std::uint16_t* sums) const {
  rows.clear();
  for (const CellOffset& offset : offsets) {
    const int block_y = floor_divide(offset.y, side_);
    const int at_row = row + block_y + 1;
    if (at_row < 0 || at_row >= plane_rows_) continue;
    const int block_x = floor_divide(offset.x, side_);
    const int column = std::clamp(block_x, -blocks_x_ - 1, blocks_x_);
    if (column != block_x) continue;  // all zeros
    const int phase = (offset.y - block_y * side_) * side_ + (offset.x - block_x * side_);
    rows.push_back(planes_.data() + static_cast<std::size_t>(phase) * plane_size_ +
                   static_cast<std::size_t>(at_row) * stride_ +
                   static_cast<std::size_t>(left_ + 1 + column + begin));
  }
  sum_block_rows(rows, static_cast<std::size_t>(end - begin), sums + begin);
}

}  // namespace strata::localization
