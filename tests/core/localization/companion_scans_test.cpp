// SPDX-License-Identifier: Apache-2.0
#include "core/localization/companion_scans.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace strata::localization {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kNoReturn = std::numeric_limits<float>::infinity();

/// Beams of 1 degree over a field around the mounting's heading, all with the same reading.
Observation look(const Pose2& mounting, int field_deg, double stamp_s, float range_m = 2.0F) {
  Observation seen;
  seen.scan.stamp = Stamp::from_seconds(stamp_s);
  seen.scan.angle_min_rad = static_cast<float>(-0.5 * field_deg * kPi / 180.0);
  seen.scan.angle_increment_rad = static_cast<float>(kPi / 180.0);
  seen.scan.range_max_m = 20.0F;
  seen.scan.ranges_m.assign(static_cast<std::size_t>(field_deg), range_m);
  seen.scan.robot_from_laser = mounting;
  return seen;
}

const Pose2 kFront{0.3, 0.2, kPi / 4.0};
const Pose2 kBack{-0.3, -0.2, -3.0 * kPi / 4.0};

TEST(CompanionScans, WhatTwoScannersSeeInOneDirectionCountsOnce) {
  CompanionScans scans;
  const Observation back = look(kBack, 270, 1.0);
  const Observation front = look(kFront, 270, 1.05);
  scans.keep(back);
  scans.keep(front);
  const auto& taken = scans.take(front);
  ASSERT_EQ(taken.size(), 1U);
  // The front scanner has seen from -90 to 180 degrees: a quarter of the circle is left, to the
  // five degrees that directions are counted in.
  EXPECT_NEAR(static_cast<double>(count_beams(taken[0]->scan).hits), 90.0, 10.0);
  EXPECT_EQ(count_beams(taken[0]->observation.scan).hits, 270U);  // what is learned from is whole
  for (std::size_t beam = 0; beam < taken[0]->scan.size(); ++beam) {
    const double heading = kBack.theta + taken[0]->scan.bearing_rad(beam);
    if (std::cos(heading - kFront.theta) > std::cos(130.0 * kPi / 180.0)) {
      EXPECT_TRUE(std::isnan(taken[0]->scan.ranges_m[beam])) << heading;
    }
  }
  EXPECT_NEAR(scans.own_share(), 0.75, 0.03);
  EXPECT_DOUBLE_EQ(scans.own_share() + taken[0]->share, 1.0);
}

TEST(CompanionScans, WhereOneHasNoHitTheOtherCounts) {
  CompanionScans scans;
  const Observation front = look(kFront, 270, 1.05, kNoReturn);
  scans.keep(look(kBack, 270, 1.0));
  scans.keep(front);
  const auto& taken = scans.take(front);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(count_beams(taken[0]->scan).hits, 270U);
  EXPECT_DOUBLE_EQ(scans.own_share(), 0.0);
}

TEST(CompanionScans, AScanIsTakenOnceAndAloneHasAllBeams) {
  CompanionScans scans;
  scans.keep(look(kBack, 270, 1.0));
  EXPECT_EQ(scans.take(look(kFront, 270, 1.05)).size(), 1U);
  EXPECT_EQ(scans.take(look(kFront, 270, 1.15)).size(), 0U);
  EXPECT_DOUBLE_EQ(scans.own_share(), 1.0);
  scans.keep(look(kBack, 270, 1.2));
  EXPECT_EQ(scans.take(look(kFront, 270, 1.8)).size(), 0U);  // too long ago
}

}  // namespace
}  // namespace strata::localization
