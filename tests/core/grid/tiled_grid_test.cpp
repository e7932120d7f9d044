// SPDX-License-Identifier: Apache-2.0
#include "core/grid/tiled_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/count_scans.hpp"
#include "core/grid/tiled_traversal.hpp"
#include "tests/support/same_bits.hpp"

namespace strata {
namespace {

constexpr double kResolution = 0.05;

/// Ends of rays on both sides of the origin, some along an axis, some within a cell.
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> rays() {
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> result;
  for (int i = 0; i < 200; ++i) {
    const double angle = 0.0314159 * i * 1.7;
    const double length_m = i % 20 == 0 ? 0.01 : 0.3 * (i % 40);
    const Eigen::Vector2d from(0.037 * (i % 13) - 0.2, 0.041 * (i % 7) - 0.1);
    result.emplace_back(from, from + length_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  result.emplace_back(Eigen::Vector2d(-3.0, 0.01), Eigen::Vector2d(4.0, 0.01));
  result.emplace_back(Eigen::Vector2d(0.01, 4.0), Eigen::Vector2d(0.01, -3.0));
  return result;
}

TEST(TiledGrid, IsCrossedAsAGridToTheLastBit) {
  const CellRect rect{{-300, -290}, {310, 333}};
  Grid<double> dense(kResolution, rect);
  TiledGrid<double> tiled(kResolution, rect);
  for (const auto& [from, to] : rays()) {
    traverse_ray(dense, from, to, [&](std::size_t index, double length_m) {
      dense.values()[index] += 0.1 * length_m + 1e-3;
    });
    traverse_ray(tiled, from, to,
                 [&](double& value, double length_m) { value += 0.1 * length_m + 1e-3; });
  }
  EXPECT_TRUE(test::same_bits(tiled.dense(), dense));
  EXPECT_TRUE(test::same_bits(TiledGrid<double>(dense).dense(), dense));
}

TEST(TiledGrid, KeepsItsValuesWhereItGrows) {
  Grid<int> dense(kResolution, CellRect{}, -1);
  TiledGrid<int> tiled(kResolution, CellRect{}, -1);
  for (int i = 0; i < 60; ++i) {
    const Cell cell{i % 2 == 0 ? -7 * i : 5 * i, (i % 3 - 1) * 11 * i};
    const CellRect needed{cell, {cell.x + 1, cell.y + 1}};
    dense.grow(needed);
    tiled.grow(needed);
    dense.at(cell) = i;
    tiled.at(cell) = i;
  }
  ASSERT_EQ(tiled.rect(), dense.rect());
  for (std::size_t i = 0; i < dense.size(); ++i) {
    ASSERT_EQ(tiled.get(tiled.cell(i)), dense.values()[i]);
  }
  EXPECT_EQ(tiled.get({tiled.rect().max.x, 0}), -1);
}

TEST(TiledGrid, RefusesMoreColumnsThanACellsNumberHasRoomFor) {
  TiledGrid<int> tiled(kResolution, {{0, 0}, {40, 40}}, 0);
  tiled.at({39, 39}) = 7;
  const CellRect before = tiled.rect();
  EXPECT_THROW(tiled.cover({{0, 0}, {1 << TiledGrid<int>::kPitchBits, 1}}), std::bad_alloc);
  EXPECT_EQ(tiled.rect(), before);
  EXPECT_EQ(tiled.get({39, 39}), 7);
}

TEST(TiledGrid, VisitsWhatWasWrittenInTheOrderOfAGrid) {
  TiledGrid<int> tiled(kResolution, {{-40, -3}, {70, 40}}, 0);
  tiled.at({-40, 39}) = 1;
  tiled.at({69, -3}) = 2;
  std::vector<Cell> firsts;
  std::size_t cells = 0;
  tiled.visit_rows([&](const Cell& first, std::span<const int> row) {
    firsts.push_back(first);
    cells += row.size();
  });
  EXPECT_TRUE(std::is_sorted(firsts.begin(), firsts.end(), [](const Cell& a, const Cell& b) {
    return std::pair(a.y, a.x) < std::pair(b.y, b.x);
  }));
  // Of the two tiles the parts within the rectangle: 8 x 8 and 6 x 3 cells.
  EXPECT_EQ(cells, 8U * 8U + 6U * 3U);
}

/// A corridor of 200 m at 45 degrees, 3 m wide: 181 beams to walls that are straight ahead of none.
std::vector<PosedScan> corridor_scans() {
  std::vector<PosedScan> scans;
  for (int i = 0; i < 200; ++i) {
    PosedScan posed;
    posed.map_from_robot = {std::numbers::sqrt2 / 2.0 * i, std::numbers::sqrt2 / 2.0 * i,
                            std::numbers::pi / 4.0};
    posed.scan.angle_min_rad = -1.5F;
    posed.scan.angle_increment_rad = 3.0F / 180.0F;
    posed.scan.range_max_m = 30.0F;
    for (int beam = 0; beam <= 180; ++beam) {
      const double bearing_rad = -1.5 + beam * 3.0 / 180.0;
      const double across = std::max(0.1, std::abs(std::sin(bearing_rad)));
      posed.scan.ranges_m.push_back(static_cast<float>(1.5 / across));
    }
    scans.push_back(posed);
  }
  return scans;
}

// Memory follows the beams: counted in bytes that the grid has allocated, which no machine changes.
TEST(TiledGrid, CountsOfALongCorridorTakeATenthOfItsBox) {
  WorkerPool pool(1);
  const CountingMap map =
      count_scans(corridor_scans(), kResolution, {}, BeamWeights::kAllStatic, pool);
  ASSERT_GT(map.cells().size(), 7'000'000U);
  EXPECT_LT(map.cells().allocated_bytes(), map.cells().size() * sizeof(CellCounts) / 10);
}

}  // namespace
}  // namespace strata
