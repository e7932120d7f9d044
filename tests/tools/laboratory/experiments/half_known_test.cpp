// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/half_known.hpp"

#include <gtest/gtest.h>

namespace strata::experiments {
namespace {

const VerdictWorld& office() {
  static const VerdictWorld world = half_known_office(2);
  return world;
}

TEST(HalfKnown, TheRoomsOfOneRowAreNotInTheMap) {
  std::size_t known_south = 0;
  std::size_t known_north = 0;
  const ReflectionGrid& map = office().maps.filtered;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!is_known(map.values()[i])) continue;
    known_south += map.center(map.cell(i)).y() < 4.2 ? 1 : 0;
    known_north += map.center(map.cell(i)).y() > 7.0 ? 1 : 0;
  }
  EXPECT_EQ(known_south, 0U);
  EXPECT_GT(known_north, 1000U);
}

TEST(HalfKnown, TheRobotGoesThereAndIsNotLost) {
  const HalfKnownOutcome outcome = drive_half_known(office(), "filtered", true, 1);
  EXPECT_EQ(outcome.runs, 1.0);
  EXPECT_GT(outcome.beyond_scans, 20.0);
  EXPECT_GT(outcome.mapped_scans, outcome.beyond_scans);
  EXPECT_EQ(outcome.lost, 0.0);
  EXPECT_LT(outcome.beyond_error_m, 0.2 * outcome.beyond_scans);
  EXPECT_LT(outcome.mapped_error_m, 0.1 * outcome.mapped_scans);
}

TEST(HalfKnown, ARunIsLostWhereTheTruthIsElsewhereForLong) {
  VerdictWorld moved = office();
  for (std::size_t i = moved.truths.size() / 2; i < moved.truths.size(); ++i) {
    moved.truths[i]->x += 1.5;
  }
  const HalfKnownOutcome outcome = drive_half_known(moved, "filtered", true, 1);
  EXPECT_EQ(outcome.lost, 1.0);
  EXPECT_GT(outcome.called_good, 0.0);
  EXPECT_EQ(outcome.high_scored_wrong > 0.0, outcome.high_scored > 0.0);
}

}  // namespace
}  // namespace strata::experiments
