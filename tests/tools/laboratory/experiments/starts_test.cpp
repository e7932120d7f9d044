// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/starts.hpp"

#include <gtest/gtest.h>

#include "tests/tools/laboratory/experiments/floor_without_change.hpp"

namespace strata::experiments {
namespace {

using test_floor::floor_without_change;

TEST(Starts, AreRightWhereNothingChangedAndEachPlaceIsItsOwn) {
  for (const bool has_search : {false, true}) {
    const StartsOutcome outcome =
        start_anywhere(floor_without_change(), "filtered", has_search, 3, 60);
    EXPECT_EQ(outcome.starts, 3.0);
    EXPECT_EQ(outcome.right, 3.0);
    EXPECT_EQ(outcome.wrong + outcome.ever_wrong, 0.0);
    EXPECT_LT(outcome.right_after_s, 3 * 5.0);
    EXPECT_GT(outcome.high_scored, 0.5 * outcome.scans);
    EXPECT_EQ(outcome.high_scored_wrong, 0.0);
  }
}

TEST(Starts, AreWrongWhereTheTruthIsElsewhere) {
  VerdictWorld moved = floor_without_change();
  for (auto& truth : moved.truths) truth->x += 2.0;
  const StartsOutcome outcome = start_anywhere(moved, "filtered", true, 3, 60);
  EXPECT_EQ(outcome.right, 0.0);
  EXPECT_EQ(outcome.wrong, 3.0);
  EXPECT_EQ(outcome.ever_wrong, 3.0);
  EXPECT_EQ(outcome.high_scored_wrong, outcome.high_scored);
}

TEST(Starts, AreOfAsManyScansAsAreAskedFor) {
  const StartsOutcome outcome = start_anywhere(floor_without_change(), "filtered", true, 2, 30);
  EXPECT_GT(outcome.scans, 0.0);
  EXPECT_LE(outcome.scans, 2 * 30.0);
}

}  // namespace
}  // namespace strata::experiments
