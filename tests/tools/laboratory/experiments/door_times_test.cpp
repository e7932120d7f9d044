// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/door_times.hpp"

#include <gtest/gtest.h>

namespace strata::experiments {
namespace {

DoorTimes of_doors(bool has_hours) {
  DoorTimes sum;
  for (std::uint64_t seed = 301; seed <= 330; ++seed) {
    const DoorTimes one = door_times(seed, has_hours);
    sum.followed += one.followed;
    sum.mornings += one.mornings;
    sum.in_time += one.in_time;
    sum.constant += one.constant;
  }
  return sum;
}

TEST(DoorTimes, OpeningHoursAreForetoldInTheMorning) {
  const DoorTimes doors = of_doors(true);
  EXPECT_EQ(doors.mornings, 30 * 30);
  EXPECT_GE(doors.followed, 24);
  EXPECT_LE(doors.in_time / doors.mornings, 0.11);
  EXPECT_LE(doors.in_time, 0.75 * doors.constant);
}

TEST(DoorTimes, DoorsWithoutHoursAreForetoldAsWellAsWithoutTheTime) {
  const DoorTimes doors = of_doors(false);
  EXPECT_LE(doors.followed, 3);
  EXPECT_LE(doors.in_time, 1.02 * doors.constant);
}

}  // namespace
}  // namespace strata::experiments
