// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/kidnapped.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/tools/laboratory/experiments/floor_without_change.hpp"

namespace strata::experiments {
namespace {

using test_floor::floor_without_change;

TEST(Kidnapped, RobotsFindThemselvesWhereNothingChangedOnlyWhenTheyAreWatched) {
  for (const bool watches : {false, true}) {
    const KidnappedOutcome outcome = carry_away(floor_without_change(), "filtered", watches, 3, 1);
    EXPECT_GE(outcome.times, 1.0);
    EXPECT_LE(outcome.times, 3.0);
    EXPECT_EQ(outcome.found, watches ? outcome.times : 0.0);
    EXPECT_EQ(outcome.found_soon, outcome.found);
    EXPECT_EQ(outcome.sure, outcome.found);
    EXPECT_EQ(outcome.sure_wrong, 0.0);
    EXPECT_LE(outcome.found_after_s, 10.0 * outcome.found);
    EXPECT_EQ(outcome.drives, 1.0);
    EXPECT_EQ(outcome.lost_drives + outcome.off + outcome.ambiguous, 0.0);
    EXPECT_LT(outcome.error_m, 0.1 * outcome.scans);
  }
}

TEST(Kidnapped, RobotsAreLostWhereTheTruthIsElsewhere) {
  VerdictWorld moved = floor_without_change();
  for (std::size_t i = 1; i < moved.truths.size(); ++i) moved.truths[i]->x += 2.0;
  const KidnappedOutcome outcome = carry_away(moved, "filtered", true, 2, 1);
  EXPECT_EQ(outcome.found, 0.0);
  EXPECT_EQ(outcome.lost_drives, 1.0);
  EXPECT_GT(outcome.off, 0.9 * outcome.scans);
}

TEST(Kidnapped, ADriveWithoutTruthIsRefused) {
  VerdictWorld world = floor_without_change();
  world.truths.assign(world.observations.size(), std::nullopt);
  EXPECT_THROW((void)carry_away(world, "filtered", true, 1, 1), InputError);
}

}  // namespace
}  // namespace strata::experiments
