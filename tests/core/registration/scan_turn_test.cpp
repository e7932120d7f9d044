// SPDX-License-Identifier: Apache-2.0
#include "core/registration/scan_turn.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::registration {
namespace {

Scan seen_from(const Pose2& pose, double field_of_view_rad, double noise_m = 0.01) {
  return test::scan_of(test::room(), pose, 10.0 * pose.theta, noise_m, 1, 360, field_of_view_rad);
}

TEST(ScanTurn, IsToldByReadingsToAFractionOfABeam) {
  for (const double field : {std::numbers::pi, 2.0 * std::numbers::pi}) {
    for (const double turn : {-0.4, -0.105, -0.003, 0.0, 0.021, 0.3}) {
      const Pose2 before{3.5, 4.0, 0.2};
      const Pose2 now{3.5, 4.0, 0.2 + turn};
      const auto told = turn_between(seen_from(before, field), seen_from(now, field));
      ASSERT_TRUE(told) << turn;
      EXPECT_NEAR(*told, turn, 0.004) << field;
    }
  }
}

TEST(ScanTurn, IsHardlyChangedByAStepOfTheRobot) {
  const auto told = turn_between(seen_from({3.5, 4.0, 0.2}, std::numbers::pi),
                                 seen_from({3.6, 4.02, 0.3}, std::numbers::pi));
  ASSERT_TRUE(told);
  EXPECT_NEAR(*told, 0.1, 0.02);
}

TEST(ScanTurn, IsNotToldOfScansWithOtherBeams) {
  const Scan before = seen_from({3.5, 4.0, 0.0}, std::numbers::pi);
  Scan fewer = before;
  fewer.ranges_m.pop_back();
  EXPECT_FALSE(turn_between(before, fewer));
  EXPECT_FALSE(turn_between(before, seen_from({3.5, 4.0, 0.0}, 2.0)));
  EXPECT_FALSE(turn_between(Scan{}, Scan{}));
}

TEST(ScanTurn, IsNotToldWhereEveryTurnFits) {
  Scan round = seen_from({3.5, 4.0, 0.0}, std::numbers::pi);
  for (float& range : round.ranges_m) range = 3.0F;
  EXPECT_FALSE(turn_between(round, round));
  for (float& range : round.ranges_m) range = NAN;
  EXPECT_FALSE(turn_between(round, round));
}

}  // namespace
}  // namespace strata::registration
