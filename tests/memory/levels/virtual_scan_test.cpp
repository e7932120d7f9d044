// SPDX-License-Identifier: Apache-2.0
#include "memory/levels/virtual_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "tests/memory/levels/room_scans.hpp"

namespace strata::memory {
namespace {

using room_scans::kBins;
using room_scans::kPi;
using room_scans::observe;
using room_scans::room;
using room_scans::transform;

/// The same room with a box of 0.4 m radius around (2, 0).
double room_with_pillar(const Eigen::Vector2d& from, double angle) {
  const Eigen::Vector2d to_center = Eigen::Vector2d(2.0, 0.0) - from;
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  const double along = to_center.dot(direction);
  const double aside_squared = to_center.squaredNorm() - along * along;
  if (along > 0.0 && aside_squared < 0.16) return along - std::sqrt(0.16 - aside_squared);
  return room(from, angle);
}

int known(const VirtualScan& scan) {
  int count = 0;
  for (const float range : scan) count += std::isnan(range) ? 0 : 1;
  return count;
}

TEST(VirtualScan, EqualsTheScanAtTheScannersOwnPlace) {
  const Pose2 pose{0.3, 0.7, 0.25};
  const VirtualScan result = transform(observe(room, pose, 720, 2.0 * kPi), pose.translation());
  for (int a = 0; a < 360; ++a) {
    const double expected = room(pose.translation(), kBins.center_bearing_rad(a));
    EXPECT_NEAR(static_cast<double>(result[static_cast<std::size_t>(a)]), expected, 0.1) << a;
  }
}

// Defect 5: the offset is x_r - x_n and the angle needs atan2; with the printed signs every one of
// these ranges is wrong.
TEST(VirtualScan, ShowsWhatTheNodeWouldMeasureFromItsOwnPlace) {
  const Eigen::Vector2d node(-0.2, 0.4);
  RandomStream random(1, StreamId::kTest);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose2 pose{node.x() + random.uniform(-0.5, 0.5), node.y() + random.uniform(-0.5, 0.5),
                     random.uniform(-kPi, kPi)};
    const Pose2 mounting{0.25, -0.1, 0.4};
    const VirtualScan result = transform(observe(room, pose, 720, 2.0 * kPi, mounting), node);
    EXPECT_GE(known(result), 300);
    for (int a = 0; a < 360; ++a) {
      const float range = result[static_cast<std::size_t>(a)];
      if (std::isnan(range)) continue;
      // Anywhere within the bin; walls at a grazing angle change by decimetres within it.
      double low = 1e9;
      double high = 0.0;
      for (int k = -10; k <= 10; ++k) {
        const double at =
            room(node, kBins.center_bearing_rad(a) + 0.055 * k * kBins.angle_bin_rad());
        low = std::min(low, at);
        high = std::max(high, at);
      }
      EXPECT_GE(static_cast<double>(range), low - 1e-3);
      EXPECT_LE(static_cast<double>(range), high + 1e-3);
    }
  }
}

TEST(VirtualScan, RejectsPointsThatTheNodeCannotSee) {
  const Eigen::Vector2d node(0.0, 0.0);
  const VirtualScan result =
      transform(observe(room_with_pillar, {0.0, 0.7, -0.5}, 720, 2.0 * kPi), node);
  // The wall behind the pillar, seen past it from the robot, is hidden from the node.
  const double half_width = std::asin(0.4 / 2.0);
  int behind = 0;
  int in_front = 0;
  for (int a = 0; a < 360; ++a) {
    const double bearing = wrap_angle(kBins.center_bearing_rad(a));
    const float range = result[static_cast<std::size_t>(a)];
    if (std::abs(bearing) > half_width - 0.03 || std::isnan(range)) continue;
    (range > 2.5F ? behind : in_front) += 1;
  }
  EXPECT_EQ(behind, 0);
  EXPECT_GT(in_front, 5);
}

TEST(VirtualScan, FillsTheBinsBetweenTheBeamsOfACoarseScanner) {
  // 61 beams over 180 degrees: three angle bins a beam.
  const Pose2 pose{0.0, 0.5, 0.0};
  const PosedScan scan = observe(room, pose, 61, kPi);
  const VirtualScan filled = transform(scan, pose.translation());
  EXPECT_GE(known(filled), 170);
  for (int a = 0; a < 360; ++a) {
    const float range_m = filled[static_cast<std::size_t>(a)];
    if (std::isnan(range_m)) continue;
    EXPECT_NEAR(static_cast<double>(range_m), room(pose.translation(), kBins.center_bearing_rad(a)),
                0.16)
        << a;
  }
  VisibilityConfig as_the_paper;
  as_the_paper.fill_between_beams = false;
  EXPECT_LE(known(transform(scan, pose.translation(), as_the_paper)), 61);
}

TEST(VirtualScan, LeavesTheGapBetweenTwoSurfacesUnknown) {
  // The pillar stands 3 m before the wall: no beam says what is beside its edge.
  const Pose2 pose{0.0, 0.0, 0.0};
  const VirtualScan result = transform(observe(room_with_pillar, pose, 61, kPi), {0.0, 0.0});
  int between = 0;
  for (int a = -20; a < 20; ++a) {
    const float range_m = result[static_cast<std::size_t>((a + 360) % 360)];
    if (range_m > 2.1F && range_m < 4.9F) ++between;
  }
  EXPECT_EQ(between, 0);
}

TEST(VirtualScan, IsEmptyForANodeBehindAWall) {
  VirtualScan result;
  EXPECT_FALSE(VirtualScanner(kBins, {}).transform(observe(room, {4.8, 0.0, 0.0}, 360, 2.0 * kPi),
                                                   {5.3, 0.0}, result));
  EXPECT_EQ(known(result), 0);
}

TEST(VirtualScan, LetsAHalfCircleScannerFillANodeThatItJustLeft) {
  const Pose2 mounting{0.25, 0.0, 0.0};
  const PosedScan scan = observe(room, {0.2, 0.0, 0.0}, 180, kPi, mounting);
  EXPECT_GE(known(transform(scan, {0.0, 0.0})), 110);
  VisibilityConfig strict;
  strict.own_place_m = 0.0;
  EXPECT_EQ(known(transform(scan, {0.0, 0.0}, strict)), 0);
  // Nothing is known about what lies behind.
  EXPECT_TRUE(std::isnan(transform(scan, {0.0, 0.0})[180]));
}

TEST(VirtualScan, OverflowsWhereTheScanReachesFarEnough) {
  const auto corridor = [](const Eigen::Vector2d& from, double angle) {
    const double s = std::sin(angle);
    const double range = s > 0.0 ? (1.0 - from.y()) / s : (-1.0 - from.y()) / s;
    return std::min(range, 30.0);
  };
  const PosedScan scan = observe(corridor, {0.1, 0.0, 0.0}, 360, 2.0 * kPi);
  ASSERT_EQ(scan.scan.kind(180), BeamKind::kNoReturn);
  const VirtualScan result = transform(scan, {0.0, 0.0});
  EXPECT_TRUE(std::isinf(result[0]));
  EXPECT_TRUE(std::isinf(result[179]));
  EXPECT_NEAR(static_cast<double>(result[90]), 1.0, 0.01);
  VisibilityConfig distrust;
  distrust.trust_no_return = false;
  EXPECT_TRUE(std::isnan(transform(scan, {0.0, 0.0}, distrust)[0]));
}

TEST(VirtualScan, WhatNoBeamLooksAtIsNotOpenHoweverNearTheLimitIs) {
  // A half circle ahead; the node lies 0.6 m ahead, so that the ground about the laser that is
  // taken as free ends further behind it than the limit.
  const PolarBins near{360, 20, 1.5};
  const PosedScan scan = observe(room, {0.0, 0.0, 0.0}, 180, kPi);
  VirtualScanner scanner(near, {});
  VirtualScan result;
  ASSERT_TRUE(scanner.transform(scan, {0.6, 0.0}, result));
  EXPECT_TRUE(std::isnan(result[180])) << "behind: " << result[180];
  EXPECT_TRUE(std::isinf(result[0])) << "ahead, where the wall is 4.4 m away";
}

TEST(VirtualScan, LeavesOutBeamsThatArePeople) {
  PosedScan scan = observe(room, {0.0, 0.0, 0.0}, 360, 2.0 * kPi);
  scan.static_probability.assign(360, 1.0F);
  for (std::size_t beam = 100; beam < 120; ++beam) {
    scan.scan.ranges_m[beam] = 0.5F;
    scan.static_probability[beam] = 0.01F;
  }
  const int bin = static_cast<int>(std::fmod(scan.scan.bearing_rad(110) + 2.0 * kPi, 2.0 * kPi) /
                                   kBins.angle_bin_rad());
  EXPECT_NEAR(static_cast<double>(transform(scan, {0, 0})[static_cast<std::size_t>(bin)]), 0.5,
              1e-3);
  VisibilityConfig config;
  config.min_static_probability = 0.5;
  EXPECT_TRUE(std::isnan(transform(scan, {0, 0}, config)[static_cast<std::size_t>(bin)]));
}

TEST(VirtualScan, SurvivesScansWithoutAnyReading) {
  PosedScan scan = observe(room, {0.0, 0.0, 0.0}, 360, 2.0 * kPi);
  for (float& range : scan.scan.ranges_m) range = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(known(transform(scan, {0.0, 0.0})), 0);
  scan.scan.ranges_m.clear();
  EXPECT_EQ(known(transform(scan, {0.0, 0.0})), 0);
}

TEST(VirtualScan, DoesNotDependOnTheDirectionOfTheSweep) {
  PosedScan scan = observe(room, {0.1, 0.2, 0.0}, 360, 2.0 * kPi);
  const VirtualScan forward = transform(scan, {0.0, 0.0});
  std::reverse(scan.scan.ranges_m.begin(), scan.scan.ranges_m.end());
  scan.scan.angle_min_rad = static_cast<float>(scan.scan.bearing_rad(359));
  scan.scan.angle_increment_rad = -scan.scan.angle_increment_rad;
  const VirtualScan backward = transform(scan, {0.0, 0.0});
  int different = 0;
  for (std::size_t a = 0; a < 360; ++a) {
    // Bearings round differently, so a point may change its bin.
    different += std::isnan(forward[a]) != std::isnan(backward[a]) ||
                         std::abs(forward[a] - backward[a]) > 0.1F
                     ? 1
                     : 0;
  }
  EXPECT_LE(different, 4);
}

}  // namespace
}  // namespace strata::memory
