// SPDX-License-Identifier: Apache-2.0
// Halls in which a scan fits as well wherever the robot turns.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/slam/slam.hpp"
#include "core/tracking/tracker.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

using test::record_with;
using test::run_slam;
using test::Wall;
using test::worst_error;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Walls of a round hall, six metres from its middle.
std::vector<Wall> round_hall() {
  std::vector<Wall> walls;
  constexpr int kSides = 180;
  for (int i = 0; i < kSides; ++i) {
    const double a = 2.0 * std::numbers::pi * i / kSides;
    const double b = 2.0 * std::numbers::pi * (i + 1) / kSides;
    walls.push_back({6.0 * std::cos(a), 6.0 * std::sin(a), 6.0 * std::cos(b), 6.0 * std::sin(b)});
  }
  return walls;
}

/// Turns a good half round on the way across the hall.
std::vector<Pose2> across_a_hall() {
  std::vector<Pose2> path;
  for (int i = 0; i < 120; ++i) path.push_back({0.01 * i, 0.5, wrap_angle(0.03 * i)});
  return path;
}

TEST(OpenHeading, OfARoundHallIsSaidAndLeftToOdometry) {
  const std::vector<Pose2> path = across_a_hall();
  for (const double noise_m : {0.01, 0.03}) {
    const std::vector<Observation> log = record_with(180, round_hall(), path, noise_m);
    const SlamResult result = run_slam(log);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("leave the heading open")));
    const double turned_rad =
        between(log.front().odom_from_robot, log.back().odom_from_robot).theta;
    const double found_rad =
        between(result.scans.front().map_from_robot, result.scans.back().map_from_robot).theta;
    EXPECT_NEAR(angle_difference(found_rad, turned_rad), 0.0, 0.05);
  }
}

TEST(OpenHeading, IsNoneInARoundHallWithAStraightWall) {
  std::vector<Wall> walls = round_hall();
  walls.push_back({4.0, -4.5, 4.0, 4.5});
  const std::vector<Pose2> path = across_a_hall();
  const SlamResult result = run_slam(record_with(180, walls, path));
  EXPECT_THAT(result.warnings, IsEmpty());
  EXPECT_LT(worst_error(result, path, 0), 0.06);
}

/// Across the hall, turning, with wheels that spin from some scan on: odometry counts the turns,
/// and so much too far ahead that the robot would be outside. Scans come seldom enough to believe
/// that.
struct SpunWheels {
  static constexpr std::size_t kFrom = 30;
  static constexpr double kPeriodS = 2.2;
  std::vector<Observation> log;
  std::vector<Pose2> path;
  SpunWheels(double too_far_m, double turn_rad) {
    Pose2 pose{0.0, 0.5, 0.0};
    for (std::size_t i = 0; i < 120; ++i) {
      path.push_back(pose);
      pose = {pose.x + 0.01, pose.y, wrap_angle(pose.theta + turn_rad)};
    }
    log = record_with(180, round_hall(), path);
    log.front().odom_from_robot = path.front();
    for (std::size_t i = 1; i < log.size(); ++i) {
      Pose2 step = between(path[i - 1], path[i]);
      if (i > kFrom) step.x += too_far_m;
      log[i].odom_from_robot = log[i - 1].odom_from_robot * step;
      log[i].scan.stamp = Stamp::from_seconds(kPeriodS * static_cast<double>(i));
    }
  }
};

TEST(OpenHeading, IsOdometrysAndThePositionTheScansWhereWheelsSpin) {
  for (const double too_far_m : {7.0, 10.0}) {
    for (const double turn_rad : {0.03, 0.1, 0.3}) {
      const SpunWheels drive(too_far_m, turn_rad);
      Tracker tracker({}, 0.05, 0, drive.path.front());
      double off_m = 0.0;
      double off_rad = 0.0;
      for (std::size_t i = 0; i < drive.log.size(); ++i) {
        const Pose2& counted = drive.log[i].odom_from_robot;
        const Pose2 found = tracker.add(drive.log[i].scan, &counted, i).run_from_robot.mean;
        off_m = std::max(off_m, translation_distance(found, drive.path[i]));
        off_rad = std::max(off_rad, std::abs(angle_difference(found.theta, counted.theta)));
      }
      EXPECT_LT(off_m, 0.1) << too_far_m << " m, " << turn_rad << " rad";
      EXPECT_LT(off_rad, 0.1) << too_far_m << " m, " << turn_rad << " rad";
    }
  }
}

}  // namespace
}  // namespace strata::slam
