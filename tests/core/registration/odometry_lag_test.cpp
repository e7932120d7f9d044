// SPDX-License-Identifier: Apache-2.0
#include "core/registration/odometry_lag.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::registration {
namespace {

/// A drive whose turns come at no regular times; the heading is a sum of three swings.
Pose2 pose_at(double s) {
  return {3.5 + 0.3 * std::sin(0.05 * s), 4.0,
          0.7 * std::sin(0.31 * s) + 0.4 * std::sin(0.83 * s + 1.0) + 0.2 * std::sin(1.9 * s)};
}

std::vector<Scan> drive(double duration_s, double noise_m = 0.02) {
  std::vector<Scan> scans;
  for (double s = 0.0; s < duration_s; s += 0.11) {
    scans.push_back(test::scan_of(test::room(), pose_at(s), s, noise_m));
  }
  return scans;
}

std::vector<ScanTurn> turns_of_all(const std::vector<Scan>& scans) {
  std::vector<const Scan*> all;
  for (const Scan& scan : scans) all.push_back(&scan);
  return turns_of(all);
}

/// Odometry whose stamps are late by lag_s, with an error of 1 degree a second.
OdometryAt late(double lag_s) {
  return [lag_s](Stamp stamp) -> std::optional<Pose2> {
    const double s = stamp.seconds() - lag_s;
    Pose2 pose = pose_at(s);
    pose.theta += 0.017 * s;
    return pose;
  };
}

TEST(OdometryLag, IsFoundToAHundredthOfASecond) {
  const std::vector<ScanTurn> turns = turns_of_all(drive(60.0));
  ASSERT_GT(turns.size(), 400U);
  for (const double lag_s : {-1.1, -0.3, -0.06, 0.0, 0.1, 0.64, 1.7}) {
    const OdometryLag found = estimate_odometry_lag(turns, late(lag_s));
    EXPECT_TRUE(found.certain) << lag_s;
    EXPECT_NEAR(found.lag_s, lag_s, 0.01);
    EXPECT_LE(found.cost, found.cost_without);
  }
}

TEST(OdometryLag, IsNotCertainOfARobotThatDoesNotTurn) {
  std::vector<Scan> scans;
  for (double s = 0.0; s < 60.0; s += 0.11) {
    scans.push_back(test::scan_of(test::room(), {3.5 + 0.01 * s, 4.0, 0.3}, s, 0.02));
  }
  const OdometryLag found = estimate_odometry_lag(
      turns_of_all(scans), [](Stamp) -> std::optional<Pose2> { return Pose2{}; });
  EXPECT_FALSE(found.certain);
  EXPECT_EQ(found.lag_s, 0.0);
}

TEST(OdometryLag, IsNotCertainOfOdometryThatHasNothingToDoWithTheScans) {
  const std::vector<ScanTurn> turns = turns_of_all(drive(60.0));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, StreamId::kTest, 0);
    const double a = 0.2 + random.uniform();
    const double b = 0.2 + 2.0 * random.uniform();
    const OdometryLag found =
        estimate_odometry_lag(turns, [a, b](Stamp stamp) -> std::optional<Pose2> {
          const double s = stamp.seconds();
          return Pose2{0.0, 0.0, 0.6 * std::sin(a * s) + 0.5 * std::sin(b * s + 2.0)};
        });
    EXPECT_FALSE(found.certain) << seed << " " << found.lag_s;
  }
}

TEST(OdometryLag, IsNotCertainWithoutOdometryOrScans) {
  EXPECT_FALSE(estimate_odometry_lag({}, late(0.3)).certain);
  const std::vector<ScanTurn> turns = turns_of_all(drive(60.0));
  EXPECT_FALSE(estimate_odometry_lag(turns, nullptr).certain);
  EXPECT_FALSE(estimate_odometry_lag(turns, [](Stamp) -> std::optional<Pose2> {
                 return std::nullopt;
               }).certain);
}

TEST(OdometryLag, TakesTheMiddleOfASweepForItsMoment) {
  Scan first = test::scan_of(test::room(), pose_at(1.0), 1.0);
  Scan second = test::scan_of(test::room(), pose_at(1.1), 1.1);
  first.time_increment_s = second.time_increment_s = 0.1F / 179.0F;
  const auto turns = turns_of(std::vector<const Scan*>{&first, &second});
  ASSERT_EQ(turns.size(), 1U);
  EXPECT_NEAR(turns[0].from.seconds(), 1.05, 1e-6);
  EXPECT_NEAR(turns[0].to.seconds(), 1.15, 1e-6);
}

}  // namespace
}  // namespace strata::registration
