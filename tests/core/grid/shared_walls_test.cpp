// SPDX-License-Identifier: Apache-2.0
#include "core/grid/shared_walls.hpp"

#include <gtest/gtest.h>

namespace strata {
namespace {

/// A room of 40 x 30 cells with its least corner there.
ReflectionGrid room(int x, int y) {
  ReflectionGrid map = make_reflection_grid(0.05, {{-100, -100}, {100, 100}});
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 30; ++j) {
      const bool is_wall = i == 0 || i == 40 || j == 0 || j == 30;
      map.at({x + i, y + j}) = is_wall ? 1.0F : 0.0F;
    }
  }
  return map;
}

TEST(SharedWalls, AreAllOfThemInTheSameMapAndInOneACellAside) {
  EXPECT_EQ(shared_walls(room(0, 0), room(0, 0)), 1.0);
  EXPECT_EQ(shared_walls(room(0, 0), room(1, 1)), 1.0);
}

TEST(SharedWalls, AreFewInAMapOfAnotherFrameOrOfAPart) {
  EXPECT_LT(shared_walls(room(0, 0), room(8, 9)), 0.1);
  ReflectionGrid part = room(0, 0);
  for (int i = 0; i <= 40; ++i) {
    for (int j = 4; j <= 30; ++j) part.at({i, j}) = kUnknownReflection;
  }
  EXPECT_LT(shared_walls(room(0, 0), part), 0.5);
  EXPECT_EQ(shared_walls(part, room(0, 0)), 1.0) << "what is known already has not gone";
}

TEST(SharedWalls, OfNothingAreComplete) {
  EXPECT_EQ(shared_walls(ReflectionGrid{}, room(0, 0)), 1.0);
  EXPECT_EQ(shared_walls(room(0, 0), ReflectionGrid{}), 0.0);
}

}  // namespace
}  // namespace strata
