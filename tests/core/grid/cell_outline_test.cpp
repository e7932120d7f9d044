// SPDX-License-Identifier: Apache-2.0
#include "core/grid/cell_outline.hpp"

#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata {
namespace {

using testing::ElementsAre;

double area(const std::vector<CellPolygon>& polygons) {
  double sum = 0.0;
  for (const CellPolygon& polygon : polygons) {
    sum += signed_area(polygon.outer);
    for (const CellRing& hole : polygon.holes) sum += signed_area(hole);
  }
  return sum;
}

TEST(CellOutline, OfARectangleHasItsFourCorners) {
  const auto polygons = outline({{2, 3}, {3, 3}, {2, 4}, {3, 4}});
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_THAT(polygons[0].outer, ElementsAre(Cell{4, 3}, Cell{4, 5}, Cell{2, 5}, Cell{2, 3}));
  EXPECT_TRUE(polygons[0].holes.empty());
}

TEST(CellOutline, GoesClockwiseAroundAHole) {
  std::vector<Cell> cells;
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      if (x != 1 || y != 1) cells.push_back({x, y});
    }
  }
  const auto polygons = outline(cells);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_EQ(signed_area(polygons[0].outer), 9.0);
  ASSERT_EQ(polygons[0].holes.size(), 1U);
  EXPECT_EQ(signed_area(polygons[0].holes[0]), -1.0);
}

TEST(CellOutline, TakesCellsThatOnlyTouchApart) {
  EXPECT_EQ(outline({{0, 0}, {1, 1}}).size(), 2U);
  EXPECT_EQ(outline({{1, 0}, {0, 1}}).size(), 2U);
  EXPECT_TRUE(outline({}).empty());
}

// An island in a hole is a polygon of its own, and no hole is given to it.
TEST(CellOutline, GivesAHoleToTheRingAroundIt) {
  std::vector<Cell> cells{{3, 3}};
  for (int i = 0; i < 7; ++i) {
    for (const Cell& cell : {Cell{i, 0}, Cell{i, 6}, Cell{0, i}, Cell{6, i}}) cells.push_back(cell);
  }
  const auto polygons = outline(cells);
  ASSERT_EQ(polygons.size(), 2U);
  EXPECT_EQ(polygons[0].holes.size(), 1U);
  EXPECT_TRUE(polygons[1].holes.empty());
}

TEST(CellOutline, CoversAsManyCellsAsItWasGiven) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomStream stream(seed, StreamId::kTest);
    std::vector<Cell> cells;
    for (int x = 0; x < 9; ++x) {
      for (int y = 0; y < 9; ++y) {
        if (stream.uniform() < 0.55) cells.push_back({x, y});
      }
    }
    EXPECT_EQ(area(outline(cells)), static_cast<double>(cells.size())) << seed;
  }
}

}  // namespace
}  // namespace strata
