// SPDX-License-Identifier: Apache-2.0
/// A grid whose memory follows what was written, not the box around it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "core/grid/grid.hpp"

namespace strata {

/// Values of type T on a rectangle of cells, as Grid has them, in square tiles that are allocated
/// when a cell of theirs is first written; all others have the fill value. Neighbours in x lie
/// beside each other within a tile only.
template <typename T>
class TiledGrid {
 public:
  static constexpr int kSideBits = 5;
  static constexpr int kSide = 1 << kSideBits;  ///< of a tile, in cells
  /// Bits of a cell's number that say its column; a grid is never wider.
  static constexpr int kPitchBits = 26;
  /// Room for tiles beyond those needed, on the sides that grow.
  static constexpr int kSpareTiles = 8;

  explicit TiledGrid(double resolution_m = 0.05, const CellRect& rect = {}, const T& fill = T())
      : resolution_m_(resolution_m), fill_(fill) {
    cover(rect);
  }
  /// The values that are not the fill value, to the bit. O(area).
  explicit TiledGrid(const Grid<T>& grid)
      : TiledGrid(grid.resolution_m(), grid.rect(), grid.fill()) {
    static_assert(std::is_trivially_copyable_v<T>);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (std::memcmp(&grid.values()[i], &fill_, sizeof(T)) != 0) {
        at(grid.cell(i)) = grid.values()[i];
      }
    }
  }

  [[nodiscard]] double resolution_m() const { return resolution_m_; }
  [[nodiscard]] const CellRect& rect() const { return rect_; }
  [[nodiscard]] bool contains(const Cell& cell) const { return rect_.contains(cell); }
  /// Cells of the rectangle, allocated or not.
  [[nodiscard]] std::size_t size() const { return rect_.area(); }
  [[nodiscard]] const T& fill() const { return fill_; }
  /// The cell of a place in Grid::values().
  [[nodiscard]] Cell cell(std::size_t index) const {
    const auto width = static_cast<std::size_t>(rect_.width());
    return {rect_.min.x + static_cast<int>(index % width),
            rect_.min.y + static_cast<int>(index / width)};
  }
  /// What its tiles hold.
  [[nodiscard]] std::size_t allocated_bytes() const {
    const auto count = std::count_if(tiles_.begin(), tiles_.end(),
                                     [](const std::vector<T>& tile) { return !tile.empty(); });
    return static_cast<std::size_t>(count) * kSide * kSide * sizeof(T);
  }

  /// The value, or the fill value outside and where nothing was written. O(1).
  [[nodiscard]] const T& get(const Cell& cell) const {
    if (!contains(cell)) return fill_;
    const std::vector<T>& tile = tiles_[tile_index(cell)];
    return tile.empty() ? fill_ : tile[within(cell)];
  }
  /// Allocates the cell's tile; the reference holds as long as the grid. Requires contains(cell).
  [[nodiscard]] T& at(const Cell& cell) { return tile(tile_index(cell))[within(cell)]; }

  /// Makes the rectangle hold `needed` too. Throws std::bad_alloc, and stays as it is, for one of
  /// 2^kPitchBits columns or more. O(tiles) when it grows.
  void cover(const CellRect& needed) {
    const CellRect rect = rect_.united(needed);
    CellRect wide = tiles_of(rect).united(directory_);
    if (wide.width() > kMaxTilesWide) throw std::bad_alloc();  // a cell's number has no room
    if (wide != directory_) {
      if (!directory_.empty()) {
        if (wide.min.x < directory_.min.x) wide.min.x -= kSpareTiles;
        if (wide.min.y < directory_.min.y) wide.min.y -= kSpareTiles;
        if (wide.max.x > directory_.max.x) wide.max.x += kSpareTiles;
        if (wide.max.y > directory_.max.y) wide.max.y += kSpareTiles;
      }
      std::vector<std::vector<T>> moved(wide.area());
      for (int y = directory_.min.y; y < directory_.max.y; ++y) {
        for (int x = directory_.min.x; x < directory_.max.x; ++x) {
          moved[place(wide, {x, y})] = std::move(tiles_[place(directory_, {x, y})]);
        }
      }
      tiles_ = std::move(moved);
      directory_ = wide;
    }
    rect_ = rect;
  }
  /// Grows the rectangle as Grid::grow does, with cells to spare.
  void grow(const CellRect& needed) { cover(grown(rect_, needed)); }

  /// Calls visit(Cell first, std::span<const T>) for the allocated cells of the rectangle, a piece
  /// of a row at a time, in the order of a Grid: row by row in y, x ascending. O(allocated cells +
  /// rows x tiles across).
  template <typename Visit>
  void visit_rows(Visit&& visit) const {
    for (int y = rect_.min.y; y < rect_.max.y; ++y) {
      for (int x = rect_.min.x; x < rect_.max.x;) {
        const int end = std::min(rect_.max.x, ((x >> kSideBits) + 1) << kSideBits);
        const std::vector<T>& tile = tiles_[tile_index({x, y})];
        if (!tile.empty()) {
          visit(Cell{x, y},
                std::span<const T>(&tile[within({x, y})], static_cast<std::size_t>(end - x)));
        }
        x = end;
      }
    }
  }
  [[nodiscard]] Grid<T> dense() const {
    Grid<T> result(resolution_m_, rect_, fill_);
    visit_rows([&](const Cell& first, std::span<const T> row) {
      std::copy(row.begin(), row.end(), &result.at(first));
    });
    return result;
  }

  /// Cells by number, as a traversal counts them: a step along x adds 1, one along y 2^kPitchBits.
  [[nodiscard]] std::size_t number(const Cell& cell) const {
    return (static_cast<std::size_t>(cell.y - directory_.min.y * kSide) << kPitchBits) +
           static_cast<std::size_t>(cell.x - directory_.min.x * kSide);
  }
  /// Writes cells by number; remembers the tile of the last one. Not while the grid grows.
  class Writer {
   public:
    explicit Writer(TiledGrid& grid) : grid_(grid) {}
    /// Requires a cell of the grid.
    [[nodiscard]] T& operator[](std::size_t number) {
      if ((number & kTileMask) != tile_number_) {
        tile_number_ = number & kTileMask;
        tile_ = grid_.tile(grid_.tile_index_of(number)).data();
      }
      return tile_[((number >> (kPitchBits - kSideBits)) & (kColumnMask << kSideBits)) |
                   (number & kColumnMask)];
    }

   private:
    static constexpr std::size_t kColumnMask = kSide - 1;
    static constexpr std::size_t kTileMask = ~(kColumnMask | (kColumnMask << kPitchBits));
    TiledGrid& grid_;
    std::size_t tile_number_ = ~std::size_t{0};
    T* tile_ = nullptr;
  };

 private:
  static constexpr int kMaxTilesWide = (1 << (kPitchBits - kSideBits)) - 2 * kSpareTiles;
  [[nodiscard]] static CellRect tiles_of(const CellRect& rect) {
    if (rect.empty()) return {};
    return {{rect.min.x >> kSideBits, rect.min.y >> kSideBits},
            {((rect.max.x - 1) >> kSideBits) + 1, ((rect.max.y - 1) >> kSideBits) + 1}};
  }
  [[nodiscard]] static std::size_t place(const CellRect& tiles, const Cell& tile) {
    return static_cast<std::size_t>(tile.y - tiles.min.y) *
               static_cast<std::size_t>(tiles.width()) +
           static_cast<std::size_t>(tile.x - tiles.min.x);
  }
  [[nodiscard]] std::size_t tile_index(const Cell& cell) const {
    return place(directory_, {cell.x >> kSideBits, cell.y >> kSideBits});
  }
  [[nodiscard]] std::size_t tile_index_of(std::size_t number) const {
    const std::size_t column = number & ((std::size_t{1} << kPitchBits) - 1);
    return (number >> (kPitchBits + kSideBits)) * static_cast<std::size_t>(directory_.width()) +
           (column >> kSideBits);
  }
  [[nodiscard]] static std::size_t within(const Cell& cell) {
    return static_cast<std::size_t>(((cell.y & (kSide - 1)) << kSideBits) | (cell.x & (kSide - 1)));
  }
  [[nodiscard]] std::vector<T>& tile(std::size_t index) {
    std::vector<T>& tile = tiles_[index];
    if (tile.empty()) tile.resize(static_cast<std::size_t>(kSide) * kSide, fill_);
    return tile;
  }

  double resolution_m_;
  CellRect rect_;
  T fill_;
  CellRect directory_;                 // in tiles
  std::vector<std::vector<T>> tiles_;  // row by row; empty: all fill
};

}  // namespace strata
