// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/resume.hpp"

#include <gtest/gtest.h>

namespace strata::runtime {
namespace {

Observation first_at(double time_s, bool has_odometry) {
  Observation first;
  first.scan.stamp = Stamp::from_seconds(time_s);
  first.has_odometry = has_odometry;
  return first;
}

TEST(Resume, IsDeadReckonedOnlyByOdometryOfBothScansWithinTheTime) {
  const DeadReckoningConfig config{.dead_reckoning_s = 10.0};
  const KeptMoment kept{Stamp::from_seconds(100.0), true};
  const KeptMoment blind{Stamp::from_seconds(100.0), false};
  for (const double time_s : {99.0, 100.0, 105.0, 110.0, 110.5}) {
    const bool in_time = time_s >= 100.0 && time_s <= 110.0;
    EXPECT_EQ(is_dead_reckoned(kept, first_at(time_s, true), config), in_time) << time_s;
    EXPECT_EQ(needs_odometry(kept, first_at(time_s, false), config), in_time) << time_s;
    for (const bool has_odometry : {false, true}) {
      EXPECT_FALSE(is_dead_reckoned(blind, first_at(time_s, has_odometry), config)) << time_s;
      EXPECT_FALSE(needs_odometry(blind, first_at(time_s, has_odometry), config)) << time_s;
    }
    EXPECT_FALSE(is_dead_reckoned(kept, first_at(time_s, false), config)) << time_s;
    EXPECT_FALSE(needs_odometry(kept, first_at(time_s, true), config)) << time_s;
  }
}

}  // namespace
}  // namespace strata::runtime
