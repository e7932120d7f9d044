// SPDX-License-Identifier: Apache-2.0
/// Upper bounds for what a scan may score in squares of places: a table of scores and its maxima
/// over squares of 2, 4, 8, ... cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.hpp"

namespace strata::localization {

/// Where an end point lies from the robot, in cells.
struct CellOffset {
  std::int32_t x = 0;
  std::int32_t y = 0;
};

/// A table of scores 0 ... 255, and for each level l its maxima over squares of 2^l cells; the
/// coarsest once more as planes, one for each place that an end point may have in a square, so that
/// all squares of a row are summed by whole vectors. Memory: levels + 3 bytes a cell, and of the
/// rectangle that holds the map.
class BlockBounds {
 public:
  /// End points beside the table score 0. Requires 0 <= levels <= 6.
  BlockBounds(const Grid<std::uint8_t>& scores, int levels);

  [[nodiscard]] int levels() const { return static_cast<int>(maxima_.size()) - 1; }
  /// Cells along a side of a block, 2^levels.
  [[nodiscard]] int side() const { return side_; }
  [[nodiscard]] int blocks_x() const { return blocks_x_; }
  [[nodiscard]] int blocks_y() const { return blocks_y_; }

  /// The sum, over end points at these offsets, of the greatest score that each has when the robot
  /// is in the square of 2^level cells whose least corner is `cell` (from the table's corner).
  [[nodiscard]] std::uint32_t at(int level, const Cell& cell,
                                 std::span<const CellOffset> offsets) const;

  /// The same for all blocks of a row at once, from block `begin` to `end`: sums[block]. At most
  /// 257 end points, so that 16 bits are enough. sums: blocks_x() + kSlack places, of which those
  /// beside the asked ones are rubbish afterwards. rows: working memory.
  static constexpr std::size_t kSlack = 64;
  void row_sums(int row, int begin, int end, std::span<const CellOffset> offsets,
                std::vector<const std::uint8_t*>& rows, std::uint16_t* sums) const;

 private:
  struct Maxima {
    Cell min;  // from the table's corner
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> values;
  };
  [[nodiscard]] static Maxima widened(const Maxima& maxima, int half);
  void make_planes();

  std::vector<Maxima> maxima_;  // by level
  int side_ = 1;
  int blocks_x_ = 0;
  int blocks_y_ = 0;
  std::size_t stride_ = 0;
  std::size_t plane_size_ = 0;
  int plane_rows_ = 0;
  int left_ = 0;  // columns of zeros before column -1
  std::vector<std::uint8_t> planes_;
};

}  // namespace strata::localization
