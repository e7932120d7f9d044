// SPDX-License-Identifier: Apache-2.0
#include "core/registration/sweep_timing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/registration/room_world.hpp"

namespace strata::registration {
namespace {

constexpr int kBeams = 360;
constexpr double kSweepS = 0.12;

/// A robot that turns to and fro on its way.
Pose2 turning_pose_at(double time_s) {
  return {3.5 + 0.1 * time_s, 4.0, 0.8 * std::sin(1.7 * time_s)};
}

std::optional<Pose2> odometry_at(Stamp stamp) { return turning_pose_at(stamp.seconds()); }

/// Sweeps of a room stamped `delay_s` after their first beam was taken.
std::vector<Scan> record(bool reversed, double delay_s, double turning = 1.0) {
  std::vector<Scan> scans;
  for (int k = 0; k < 60; ++k) {
    const double start_s = 0.13 * k;
    Scan scan = test::scan_of({}, {}, start_s + delay_s, 0.0, 1, kBeams, 2.0 * std::numbers::pi);
    scan.time_increment_s = static_cast<float>(kSweepS / (kBeams - 1));
    for (std::size_t beam = 0; beam < scan.size(); ++beam) {
      const auto order = static_cast<double>(reversed ? scan.size() - 1 - beam : beam);
      Pose2 pose = turning_pose_at(start_s + kSweepS * order / (kBeams - 1));
      pose.theta *= turning;
      double range_m = 100.0;
      for (const test::Wall& wall : test::room()) {
        range_m = std::min(
            range_m, test::range_to(wall, pose.x, pose.y, pose.theta + scan.bearing_rad(beam)));
      }
      scan.ranges_m[beam] = static_cast<float>(range_m);
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

TEST(SweepTiming, FindsThatBeamsRunBackwardsAndThatStampsAreLate) {
  const auto found = estimate_sweep_timing(record(true, 0.15), odometry_at);
  ASSERT_TRUE(found.certain) << found.stated_cost << " " << found.estimate_cost;
  EXPECT_TRUE(found.timing.reversed);
  EXPECT_NEAR(found.timing.delay_s, 0.15, 0.02);
  EXPECT_LT(found.estimate_cost, found.stated_cost);
}

TEST(SweepTiming, LeavesAHonestSweepAlone) {
  const auto found = estimate_sweep_timing(record(false, 0.0), odometry_at);
  EXPECT_GE(found.pairs, 8U);
  EXPECT_FALSE(found.certain);
  EXPECT_FALSE(found.timing.reversed);
  EXPECT_EQ(found.timing.delay_s, 0.0);
}

TEST(SweepTiming, StartsFromWhatIsStated) {
  const SweepTiming stated{.reversed = true, .delay_s = 0.0};
  const auto found = estimate_sweep_timing(record(true, 0.0), odometry_at, stated);
  EXPECT_FALSE(found.certain);
  EXPECT_TRUE(found.timing.reversed);
}

TEST(SweepTiming, SaysNothingAboutARobotThatDoesNotTurn) {
  const auto straight = [](Stamp stamp) -> std::optional<Pose2> {
    Pose2 pose = turning_pose_at(stamp.seconds());
    pose.theta = 0.0;
    return pose;
  };
  const auto found = estimate_sweep_timing(record(true, 0.15, 0.0), straight);
  EXPECT_EQ(found.pairs, 0U);
  EXPECT_FALSE(found.certain);
}

TEST(SweepTiming, DoesNotPreferADelayAtWhichOdometryIsMissing) {
  const auto with_holes = [](Stamp stamp) -> std::optional<Pose2> {
    const double phase_s = stamp.seconds() - 0.13 * std::floor(stamp.seconds() / 0.13 + 1e-6);
    if (phase_s > 0.05 && phase_s < 0.08) return std::nullopt;
    return turning_pose_at(stamp.seconds());
  };
  const auto found = estimate_sweep_timing(record(false, 0.0), with_holes);
  EXPECT_FALSE(found.certain) << found.timing.delay_s;
  EXPECT_EQ(found.timing.delay_s, 0.0);
}

TEST(SweepTiming, SaysNothingAboutScansWithoutTimes) {
  std::vector<Scan> scans = record(true, 0.15);
  for (Scan& scan : scans) scan.time_increment_s = 0.0F;
  EXPECT_FALSE(estimate_sweep_timing(scans, odometry_at).certain);
  EXPECT_FALSE(estimate_sweep_timing({}, odometry_at).certain);
}

}  // namespace
}  // namespace strata::registration
