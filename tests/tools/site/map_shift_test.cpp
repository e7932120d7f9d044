// SPDX-License-Identifier: Apache-2.0
#include "tools/site/map_shift.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/geometry/pose2.hpp"

namespace strata::site {
namespace {

/// A hall of 10 m x 6 m with two pillars and a wall across half of it, moved by `pose`.
ReflectionGrid hall(const Pose2& pose) {
  const double resolution_m = 0.05;
  ReflectionGrid map = make_reflection_grid(resolution_m, {{-60, -60}, {280, 220}});
  std::fill(map.values().begin(), map.values().end(), 0.0F);
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    for (int i = 0; i <= 2000; ++i) {
      const double t = i / 2000.0;
      const Eigen::Vector2d at = pose * Eigen::Vector2d(x0 + t * (x1 - x0), y0 + t * (y1 - y0));
      map.at(map.cell_at(at)) = 1.0F;
    }
  };
  // In the middle of cells, whose centres then lie on the walls.
  wall(0.025, 0.025, 10.025, 0.025);
  wall(10.025, 0.025, 10.025, 6.025);
  wall(10.025, 6.025, 0.025, 6.025);
  wall(0.025, 6.025, 0.025, 0.025);
  wall(4.025, 0.025, 4.025, 3.025);
  wall(7.025, 4.025, 7.425, 4.425);
  return map;
}

TEST(MapShift, OfAMapAgainstItselfIsNothing) {
  const MapShift shift = map_shift(hall({}), hall({}));
  EXPECT_TRUE(shift.converged);
  EXPECT_LT(shift.shift_m, 0.002);
  EXPECT_LT(shift.turn_rad, 0.0005);
  EXPECT_GT(shift.common_walls, 0.95);
}

TEST(MapShift, IsFoundToACentimetreAndATenthOfADegree) {
  for (const Pose2& moved : {Pose2{0.06, 0.0, 0.0}, Pose2{-0.11, 0.08, 0.01},
                             Pose2{0.3, 0.2, -0.03}, Pose2{0.0, 0.0, 0.02}}) {
    const MapShift shift = map_shift(hall(moved), hall({}));
    const Eigen::Vector2d middle(5.0, 3.0);
    const double error_m = (shift.from_moved * middle - moved * middle).norm();
    EXPECT_LT(error_m, 0.01) << moved.x << " " << moved.y << " " << moved.theta;
    EXPECT_NEAR(shift.from_moved.theta, moved.theta, 0.0017);
  }
}

TEST(MapShift, SaysThatOtherWallsDoNotFit) {
  ReflectionGrid other = hall({});
  for (int i = 0; i < 40; ++i) {
    for (int y = 10; y < 110; ++y) other.at({10 + 4 * i, y}) = 1.0F;
  }
  EXPECT_LT(map_shift(hall({}), other).common_walls, 0.5);
}

TEST(MapShift, LooksOnlyWhereBothMapsKnowSomething) {
  const ReflectionGrid whole = hall({});
  const ReflectionGrid part = whole.cropped({{-10, -10}, {100, 140}});
  EXPECT_GT(map_shift(part, whole).common_walls, 0.95);
  EXPECT_NEAR(known_share(whole, part), 110.0 * 150.0 / (340.0 * 280.0), 1e-9);
  EXPECT_EQ(known_share(part, whole), 1.0);
}

}  // namespace
}  // namespace strata::site
