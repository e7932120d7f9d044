// SPDX-License-Identifier: Apache-2.0
#include "core/grid/map_sharpness.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace strata {
namespace {

constexpr int kLength = 600;  // so that the ends of a wall hardly count

ReflectionGrid free_space() { return ReflectionGrid(0.05, CellRect{{0, 0}, {kLength, 60}}, 0.0F); }

ReflectionGrid with_wall(int thickness, float reflection) {
  ReflectionGrid map = free_space();
  for (int y = 0; y < thickness; ++y) {
    for (int x = 0; x < kLength; ++x) map.at({x, 30 + y}) = reflection;
  }
  return map;
}

TEST(MapSharpness, TellsTheThicknessOfStraightWalls) {
  for (const int thickness : {1, 2, 4}) {
    const MapSharpness sharpness = map_sharpness(with_wall(thickness, 1.0F));
    EXPECT_NEAR(sharpness.wall_thickness_m, 0.05 * thickness, 0.004) << thickness;
    EXPECT_EQ(sharpness.occupied_cells, static_cast<std::size_t>(kLength * thickness));
    EXPECT_EQ(sharpness.entropy_bits, 0.0);
  }
}

TEST(MapSharpness, TellsTheThicknessOfASlantedWall) {
  ReflectionGrid map = free_space();
  for (int i = 0; i < 60; ++i) map.at({i, i}) = 1.0F;
  EXPECT_NEAR(map_sharpness(map).wall_thickness_m, 0.05, 1e-9);
}

TEST(MapSharpness, EntropyGrowsWithCellsThatBeamsDisagreeOn) {
  // Of three rows that count, one is the wall: a third of h(1/2) = 1 bit.
  EXPECT_NEAR(map_sharpness(with_wall(1, 0.5F)).entropy_bits, 1.0 / 3.0, 1e-9);
  EXPECT_LT(map_sharpness(with_wall(1, 0.9F)).entropy_bits,
            map_sharpness(with_wall(1, 0.7F)).entropy_bits);
}

TEST(MapSharpness, SaysNothingOfAMapWithoutWalls) {
  for (const ReflectionGrid& map : {free_space(), ReflectionGrid()}) {
    const MapSharpness sharpness = map_sharpness(map);
    EXPECT_EQ(sharpness.occupied_cells, 0U);
    EXPECT_EQ(sharpness.entropy_bits, 0.0);
    EXPECT_EQ(sharpness.wall_thickness_m, 0.0);
  }
}

}  // namespace
}  // namespace strata
