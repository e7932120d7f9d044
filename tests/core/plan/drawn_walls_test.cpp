// SPDX-License-Identifier: Apache-2.0
#include "core/plan/drawn_walls.hpp"

#include <gtest/gtest.h>

#include "tests/core/plan/painted.hpp"

namespace strata::plan {
namespace {

bool is_wall(const ReflectionGrid& plan, double x_m, double y_m) {
  return is_occupied(plan.get(plan.cell_at({x_m, y_m})));
}

TEST(DrawnWalls, LeavesLettersOutAndPillarsIn) {
  std::vector<test::Line> lines{{{-2.0, 0.0}, {2.0, 0.0}},  // a wall
                                {{1.0, 1.0}, {1.0, 1.3}},   // a letter
                                {{1.0, 1.3}, {1.2, 1.0}},
                                {{-1.0, 0.0}, {-1.0, 0.3}}};  // a stub, on the wall
  ReflectionGrid plan = test::painted(lines, 0.015, 0.02, 3.0, 0.0F);
  for (int y = 75; y < 90; ++y) {
    for (int x = -50; x < -35; ++x) plan.at({x, y}) = 1.0F;  // 0.3 m square
  }
  const ReflectionGrid walls = drawn_walls(plan);
  EXPECT_TRUE(is_wall(walls, 0.5, 0.01));
  EXPECT_TRUE(is_wall(walls, -0.99, 0.2));
  EXPECT_TRUE(is_wall(walls, -0.9, 1.65));
  EXPECT_FALSE(is_wall(walls, 1.01, 1.15));
}

TEST(DrawnWalls, FillsWhatLiesBetweenTheTwoLinesOfAWall) {
  const ReflectionGrid walls = drawn_walls(test::painted(
      {{{-2.0, 0.0}, {2.0, 0.0}}, {{-2.0, 0.2}, {2.0, 0.2}}, {{-2.0, 0.8}, {2.0, 0.8}}}, 0.015,
      0.02, 3.0, 0.0F));
  EXPECT_TRUE(is_wall(walls, 0.3, 0.1));
  EXPECT_FALSE(is_wall(walls, 0.3, 0.5)) << "a gap that somebody could look into";
  EXPECT_FALSE(is_wall(walls, 0.3, 0.26)) << "no wall is thicker than before";
  EXPECT_FALSE(is_wall(walls, 0.3, -0.06));
}

}  // namespace
}  // namespace strata::plan
