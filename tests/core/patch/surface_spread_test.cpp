// SPDX-License-Identifier: Apache-2.0
#include "core/patch/surface_spread.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace strata::patch {
namespace {

/// A visit whose beams passed at an angle, all in one direction.
Visit passing(double angle_rad, float misses) {
  Visit visit;
  visit.add(false, misses,
            {static_cast<float>(std::cos(2.0 * angle_rad)),
             static_cast<float>(std::sin(2.0 * angle_rad))});
  return visit;
}

/// A line of cells along x.
std::vector<Cell> line(int cells) {
  std::vector<Cell> result;
  for (int x = 0; x < cells; ++x) result.push_back({x, 7});
  return result;
}

TEST(SurfaceSpread, OfALineIsCrossedByTheSquaredSineOfTheAngle) {
  const SurfaceSpread surface(line(200));  // so long that the width of a cell is nothing
  for (const double angle_deg : {0.0, 10.0, 45.0, 90.0, 135.0}) {
    const double angle = angle_deg * std::numbers::pi / 180.0;
    EXPECT_NEAR(surface.misses_across(passing(angle, 6.0F)), 6.0 * std::pow(std::sin(angle), 2),
                1e-3)
        << angle_deg;
  }
}

TEST(SurfaceSpread, WithoutADirectionIsCrossedByEveryBeam) {
  const std::vector<std::vector<Cell>> without{{{3, 4}}, {{0, 0}, {0, 1}, {1, 0}, {1, 1}}};
  for (const std::vector<Cell>& cells : without) {
    for (const double angle : {0.0, 0.4, 1.3}) {
      EXPECT_NEAR(SurfaceSpread(cells).misses_across(passing(angle, 5.0F)), 5.0, 1e-5);
    }
  }
}

TEST(SurfaceSpread, OfADiagonalIsAlongItAndNotAlongItsOtherDiagonal) {
  std::vector<Cell> cells;
  for (int i = 0; i < 100; ++i) cells.push_back({i, -i});
  const SurfaceSpread surface(cells);
  EXPECT_NEAR(surface.misses_across(passing(-0.25 * std::numbers::pi, 4.0F)), 0.0, 1e-2);
  EXPECT_NEAR(surface.misses_across(passing(0.25 * std::numbers::pi, 4.0F)), 4.0, 1e-5);
}

TEST(SurfaceSpread, CountsBeamsFromManySidesOneByOne) {
  const SurfaceSpread surface(line(200));
  Visit visit = passing(0.0, 30.0F);
  EXPECT_LT(surface.misses_across(visit), 0.1);
  visit.add(false, 2.0F, {-1.0F, 0.0F});  // two that go straight through
  EXPECT_NEAR(surface.misses_across(visit), 2.0, 0.1) << "grazing ones do not outvote them";
  EXPECT_EQ(surface.misses_across(Visit{}), 0.0);
}

TEST(SurfaceSpread, ReachesAsFarWhicheverWayTheSurfaceLies) {
  const auto extent_of = [](double angle_rad) {
    std::vector<Cell> cells;
    for (double t = 0.0; t < 20.0; t += 0.1) {
      const Cell cell{static_cast<int>(std::floor(t * std::cos(angle_rad))),
                      static_cast<int>(std::floor(t * std::sin(angle_rad)))};
      if (cells.empty() || !(cells.back() == cell)) cells.push_back(cell);
    }
    return SurfaceSpread(cells).extent(cells);
  };
  EXPECT_EQ(extent_of(0.0), 20.0);
  for (double angle_rad = -3.1; angle_rad < 3.1; angle_rad += 0.1) {
    // From the outer corner of the first cell to that of the last.
    EXPECT_GE(extent_of(angle_rad), 20.0) << angle_rad;
    EXPECT_LE(extent_of(angle_rad), 20.0 + 2.0 * std::numbers::sqrt2) << angle_rad;
  }
  const std::vector<Cell> one{{3, 4}};
  EXPECT_EQ(SurfaceSpread(one).extent(one), 1.0);
}

}  // namespace
}  // namespace strata::patch
