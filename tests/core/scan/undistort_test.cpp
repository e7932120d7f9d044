// SPDX-License-Identifier: Apache-2.0
#include "core/scan/undistort.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace strata {
namespace {

constexpr double kHalf_m = 5.0;
constexpr std::size_t kBeams = 720;

double range_in_square(double x, double y, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double ax = std::abs(c) < 1e-12 ? 1e9 : ((c > 0.0 ? kHalf_m : -kHalf_m) - x) / c;
  const double ay = std::abs(s) < 1e-12 ? 1e9 : ((s > 0.0 ? kHalf_m : -kHalf_m) - y) / s;
  return std::min(ax, ay);
}

/// A sweep in a square room by a robot that moves by start_from_end meanwhile.
Scan sweep(const Pose2& start_from_end, const Pose2& robot_from_laser) {
  Scan scan;
  scan.angle_min_rad = static_cast<float>(-std::numbers::pi);
  scan.angle_increment_rad = static_cast<float>(2.0 * std::numbers::pi / kBeams);
  scan.time_increment_s = 0.1F / kBeams;
  scan.range_max_m = 30.0F;
  scan.robot_from_laser = robot_from_laser;
  for (std::size_t i = 0; i < kBeams; ++i) {
    const double t = static_cast<double>(i) / (kBeams - 1);
    const Pose2 laser = interpolate(Pose2{}, start_from_end, t) * robot_from_laser;
    scan.ranges_m.push_back(
        static_cast<float>(range_in_square(laser.x, laser.y, laser.theta + scan.bearing_rad(i))));
  }
  return scan;
}

/// Greatest distance of an end point from the walls, in the frame of the robot at the start.
double wall_error(const Scan& scan) {
  double greatest = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.kind(i) != BeamKind::kHit) continue;
    const double r = static_cast<double>(scan.ranges_m[i]);
    const Eigen::Vector2d p =
        scan.robot_from_laser *
        Eigen::Vector2d(r * std::cos(scan.bearing_rad(i)), r * std::sin(scan.bearing_rad(i)));
    greatest = std::max(greatest, std::abs(std::max(std::abs(p.x()), std::abs(p.y())) - kHalf_m));
  }
  return greatest;
}

TEST(Undistort, PutsTheWallsBackWhereTheyWereAtTheStart) {
  const Pose2 motion{0.10, 0.02, 0.08};
  const Pose2 mounting{0.3, -0.1, 0.2};
  const Scan moved = sweep(motion, mounting);
  const Scan corrected = undistort(moved, motion);
  ASSERT_GT(wall_error(moved), 0.2);
  // A point moves to the nearest beam: half an increment at 7 m is 0.03 m.
  EXPECT_LT(wall_error(corrected), 0.035);
  EXPECT_GT(count_beams(corrected).hits, 9 * kBeams / 10);
}

TEST(Undistort, KnowsSweepsWhoseLastBeamIsTakenFirst) {
  const Pose2 motion{0.10, 0.02, 0.08};
  const Pose2 mounting{0.3, -0.1, 0.2};
  Scan reversed = sweep(motion, mounting);
  for (std::size_t i = 0; i < kBeams; ++i) {
    const double t = 1.0 - static_cast<double>(i) / (kBeams - 1);
    const Pose2 laser = interpolate(Pose2{}, motion, t) * mounting;
    reversed.ranges_m[i] = static_cast<float>(
        range_in_square(laser.x, laser.y, laser.theta + reversed.bearing_rad(i)));
  }
  ASSERT_GT(wall_error(undistort(reversed, motion)), 0.2);
  EXPECT_LT(wall_error(undistort(reversed, motion, true)), 0.035);
}

TEST(Undistort, ChangesNothingForARobotThatStands) {
  const Scan scan = sweep({}, {0.3, -0.1, 0.2});
  const Scan corrected = undistort(scan, {});
  for (std::size_t i = 0; i < kBeams; ++i) {
    EXPECT_NEAR(corrected.ranges_m[i], scan.ranges_m[i], 1e-5F) << i;
  }
}

TEST(Undistort, ReturnsAScanWithoutTimesAsItIs) {
  Scan scan = sweep({0.1, 0.0, 0.0}, {});
  scan.time_increment_s = 0.0F;
  EXPECT_EQ(undistort(scan, {0.1, 0.0, 0.0}).ranges_m, scan.ranges_m);
}

TEST(Undistort, KeepsReadingsThatAreNoHits) {
  Scan scan = sweep({}, {});
  scan.ranges_m[10] = std::numeric_limits<float>::infinity();
  scan.ranges_m[11] = std::numeric_limits<float>::quiet_NaN();
  const Scan corrected = undistort(scan, {0.0, 0.0, 1e-6});
  EXPECT_EQ(corrected.kind(10), BeamKind::kNoReturn);
  EXPECT_EQ(corrected.kind(11), BeamKind::kInvalid);
}

TEST(Undistort, WithATimeForEachBeamDoesWhatEvenTimesDo) {
  const Pose2 start_from_end{0.1, 0.02, 0.15};
  const Scan scan = sweep(start_from_end, {});
  const auto last = static_cast<float>(kBeams - 1);
  std::vector<float> offset_s;
  for (std::size_t i = 0; i < kBeams; ++i) offset_s.push_back(0.1F * static_cast<float>(i) / last);
  const Scan even = undistort(scan, start_from_end);
  const Scan timed = undistort(scan, offset_s, start_from_end, 0.1);
  // The stamp at the end of the sweep: where the robot was before, seen from where it is.
  std::vector<float> before_s;
  for (const float offset : offset_s) before_s.push_back(offset - 0.1F);
  const Scan late = undistort(scan, before_s, inverse(start_from_end), -0.1);
  std::size_t same = 0;
  for (std::size_t i = 0; i < kBeams; ++i) {
    if (even.kind(i) != BeamKind::kHit || timed.kind(i) != BeamKind::kHit) continue;
    EXPECT_NEAR(timed.ranges_m[i], even.ranges_m[i], 1e-3F) << i;
    ++same;
  }
  EXPECT_GT(same, kBeams / 2);
  EXPECT_NEAR(late.ranges_m[kBeams - 1], scan.ranges_m[kBeams - 1], 1e-4F);
  EXPECT_GT(std::abs(late.ranges_m[0] - scan.ranges_m[0]), 1e-3F);
}

}  // namespace
}  // namespace strata
