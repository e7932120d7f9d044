// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/lift_rides.hpp"

#include <gtest/gtest.h>

namespace strata::experiments {
namespace {

TEST(LiftRides, EndCertainOfTheRightLevelSoonAfterItDiffers) {
  const LiftBuilding building = lift_building(1);
  RidesOutcome sum = one_ride(building, "filtered", 0, 1, 1);
  sum += one_ride(building, "filtered", 2, 2, 2);
  EXPECT_EQ(sum.tellable, 2.0);
  EXPECT_EQ(sum.soon, 2.0);
  EXPECT_EQ(sum.ever_wrong, 0.0);
  EXPECT_LT(sum.error_m, 0.2);
}

TEST(LiftRides, ToATwinAreNotTellable) {
  const LiftBuilding building = lift_building(5);
  ASSERT_TRUE(building.has_twins);
  const std::size_t last = building.floors.size() - 1;
  EXPECT_TRUE(building.are_twins(0, last));
  EXPECT_FALSE(building.are_twins(0, 1));
  const RidesOutcome outcome = one_ride(building, "patch", 1, last, 3);
  EXPECT_EQ(outcome.tellable, 0.0);
  EXPECT_EQ(outcome.untold, 1.0);
  EXPECT_EQ(outcome.end_wrong, 0.0);
}

TEST(LiftRides, AreSeenAsTheLevelIsOnWhichTheRobotStands) {
  LiftBuilding building;
  for (const std::uint64_t seed : {1, 2}) {
    LiftFloor floor;
    floor.scenario = lift_floor(seed, seed);
    floor.walls = simulate::World(floor.scenario, seed, 60.0).walls();
    building.floors.push_back(std::move(floor));
  }
  const Ride driven = ride(building, 0, 1, 4);
  EXPECT_EQ(driven.scans.front().level, 0U);
  EXPECT_EQ(driven.scans.back().level, 1U);
  EXPECT_FALSE(driven.scans.front().is_opening);
  EXPECT_TRUE(driven.scans.back().is_opening);
  EXPECT_GT(driven.scans.back().least_difference, 0.05);
  const auto lift = lift_of(building);
  EXPECT_EQ(lift.levels.size(), 2U);
  EXPECT_TRUE(contains(lift.shape.front(), {0.0, -1.0}));
  EXPECT_FALSE(contains(lift.shape.front(), driven.scans.back().truth.translation()));
}

}  // namespace
}  // namespace strata::experiments
