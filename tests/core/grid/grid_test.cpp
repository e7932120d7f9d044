// SPDX-License-Identifier: Apache-2.0
#include "core/grid/grid.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

#include "core/grid/floor_divide.hpp"
#include "core/grid/growth.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/random/stream.hpp"

namespace strata {
namespace {

TEST(Cell, BelongsToTheLatticeByFloor) {
  EXPECT_EQ(cell_at({0.0, -0.0}, 0.05), (Cell{0, 0}));
  EXPECT_EQ(cell_at({-1e-12, 0.0499}, 0.05), (Cell{-1, 0}));
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 10'000; ++i) {
    const Cell cell{static_cast<int>(random.below(2'000)) - 1'000,
                    static_cast<int>(random.below(2'000)) - 1'000};
    ASSERT_EQ(cell_at(cell_center(cell, 0.05), 0.05), cell);
  }
}

TEST(CellRect, UnitesAndIntersectsLikeSetsOfCells) {
  RandomStream random(2, StreamId::kTest);
  auto random_rect = [&] {
    const int x = static_cast<int>(random.below(10));
    const int y = static_cast<int>(random.below(10));
    return CellRect{{x, y},
                    {x + static_cast<int>(random.below(6)), y + static_cast<int>(random.below(6))}};
  };
  for (int i = 0; i < 500; ++i) {
    const CellRect a = random_rect();
    const CellRect b = random_rect();
    const CellRect both = a.intersected(b);
    const CellRect either = a.united(b);
    for (int x = -1; x < 17; ++x) {
      for (int y = -1; y < 17; ++y) {
        const Cell cell{x, y};
        ASSERT_EQ(both.contains(cell), a.contains(cell) && b.contains(cell));
        if (a.contains(cell) || b.contains(cell)) {
          ASSERT_TRUE(either.contains(cell));
        }
      }
    }
  }
  EXPECT_TRUE((CellRect{{3, 3}, {3, 9}}).empty());
  EXPECT_EQ((CellRect{{5, 5}, {1, 1}}).area(), 0U);
}

TEST(Grid, IndexAndCellAreInverse) {
  const Grid<int> grid(0.1, {{-3, 7}, {5, 12}});
  ASSERT_EQ(grid.size(), 40U);
  for (std::size_t i = 0; i < grid.size(); ++i) ASSERT_EQ(grid.index(grid.cell(i)), i);
}

TEST(Grid, GrowsSeldomHoweverFarItGoesStepByStep) {
  Grid<std::uint8_t> grid(0.1, CellRect{});
  int grown = 0;
  for (int x = 0; x < 100'000; ++x) {
    const CellRect before = grid.rect();
    const Cell cell{x % 2 == 0 ? x / 2 : -x / 2, 0};  // both ways at once
    grid.grow(with_room(grid.rect(), {cell, {cell.x + 1, cell.y + 1}}));
    ASSERT_TRUE(grid.contains(cell));
    if (!(grid.rect() == before)) ++grown;
  }
  EXPECT_LT(grown, 50);
  EXPECT_LT(grid.width(), 2 * 100'000);
  EXPECT_LT(grid.height(), 200);
}

TEST(Grid, KeepsItsValuesWhenItGrowsInAnyDirection) {
  RandomStream random(3, StreamId::kTest);
  for (int round = 0; round < 20; ++round) {
    Grid<int> grid(0.1, CellRect{}, -1);
    std::vector<Cell> cells;
    for (int k = 0; k < 50; ++k) {
      const Cell cell{static_cast<int>(random.below(1'000)) - 500,
                      static_cast<int>(random.below(1'000)) - 500};
      grid.grow({cell, {cell.x + 1, cell.y + 1}});
      ASSERT_TRUE(grid.contains(cell));
      if (grid.at(cell) != -1) continue;
      grid.at(cell) = static_cast<int>(cells.size());
      cells.push_back(cell);
    }
    for (std::size_t k = 0; k < cells.size(); ++k) {
      ASSERT_EQ(grid.get(cells[k]), static_cast<int>(k));
    }
  }
}

TEST(Grid, CropsToAnyRectangleAndFillsTheRest) {
  Grid<int> grid(0.1, {{0, 0}, {4, 4}}, 9);
  for (std::size_t i = 0; i < grid.size(); ++i) grid.values()[i] = static_cast<int>(i);
  const Grid<int> part = grid.cropped({{2, -1}, {6, 3}});
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Cell cell = part.cell(i);
    EXPECT_EQ(part.values()[i], grid.contains(cell) ? grid.at(cell) : 9);
  }
  EXPECT_EQ(grid.cropped({{10, 10}, {12, 12}}).values(), std::vector<int>(4, 9));
  EXPECT_EQ(grid.cropped({}).size(), 0U);
  EXPECT_EQ(grid.get({-1, 0}), 9);
}

TEST(Cell, LiesInABlockByFloor) {
  for (const int by : {1, 2, 3, 64}) {
    for (int value = -200; value <= 200; ++value) {
      ASSERT_EQ(floor_divide(value, by), std::floor(static_cast<double>(value) / by))
          << value << " by " << by;
    }
  }
}

TEST(ReflectionGrid, UnknownIsNeitherFreeNorOccupied) {
  const ReflectionGrid map = make_reflection_grid(0.05, {{0, 0}, {1, 1}});
  EXPECT_FALSE(is_known(map.at({0, 0})));
  EXPECT_FALSE(is_free(map.at({0, 0})) || is_occupied(map.at({0, 0})));
  EXPECT_FALSE(is_known(map.get({5, 5})));
  EXPECT_TRUE(is_occupied(0.25F));
  EXPECT_TRUE(is_free(0.2499F));
}

}  // namespace
}  // namespace strata
