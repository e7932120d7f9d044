// SPDX-License-Identifier: Apache-2.0
// Logs that are not as they should be: a warning says so, and the rest is mapped.
#include <algorithm>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/slam/slam.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

using test::drive_round;
using test::record;
using test::record_with;
using test::ring;
using test::run_slam;
using test::Wall;
using test::worst_error;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(BadInput, AHealthyLogGivesNoWarning) {
  EXPECT_THAT(run_slam(record(ring(), drive_round(0.1, 15.0), 0, 21)).warnings, IsEmpty());
}

TEST(BadInput, AJumpOfOdometryIsNotBelieved) {
  const std::vector<Pose2> path = drive_round(0.1, 15.0);
  std::vector<Observation> log = record(ring(), path, 0, 22);
  for (std::size_t i = 60; i < log.size(); ++i) {
    log[i].odom_from_robot = Pose2{20.0, -5.0, 2.0} * log[i].odom_from_robot;
  }
  const SlamResult result = run_slam(log);
  EXPECT_LT(worst_error(result, path, 0), 0.1);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("1 jump of odometry, at 12.0 s, was not")));
}

TEST(BadInput, RepeatedScansAreSkippedAndCounted) {
  std::vector<Observation> log = record(ring(), drive_round(0.1, 8.0), 0, 23);
  const SlamResult clean = run_slam(log);
  for (const std::size_t at : {50U, 30U, 30U}) {
    log.insert(log.begin() + static_cast<std::ptrdiff_t>(at), log[at]);
  }
  const SlamResult result = run_slam(log);
  EXPECT_EQ(result.skipped_scans, 3U);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("3 scans that repeat the one before")));
  ASSERT_EQ(result.scans.size(), clean.scans.size());
  for (std::size_t i = 0; i < clean.scans.size(); ++i) {
    ASSERT_EQ(result.scans[i].map_from_robot, clean.scans[i].map_from_robot);
  }
}

TEST(BadInput, AScanThatReadsNothingSomewhereIsSkippedWhenItComesTwice) {
  std::vector<Observation> log = record(ring(), drive_round(0.1, 3.0), 0, 23);
  log[20].scan.ranges_m[7] = std::numeric_limits<float>::quiet_NaN();
  log.insert(log.begin() + 20, log[20]);
  EXPECT_EQ(run_slam(log).skipped_scans, 1U);
}

TEST(BadInput, AStuckScannerThatReadsNothingSomewhereIsNoticed) {
  std::vector<Observation> log = record(ring(), drive_round(0.1, 6.0), 0, 23);
  for (std::size_t i = 21; i < 24; ++i) log[i].scan.ranges_m = log[20].scan.ranges_m;
  for (std::size_t i = 20; i < 24; ++i) {
    log[i].scan.ranges_m[7] = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_THAT(run_slam(log).warnings, Contains(HasSubstr("3 scans repeat the one before")));
}

TEST(BadInput, AGapInTimeIsBridgedByOdometry) {
  const std::vector<Pose2> whole = drive_round(0.1, 12.0);
  std::vector<Observation> log = record(ring(), whole, 0, 24);
  for (std::size_t i = 55; i < log.size(); ++i) {
    log[i].scan.stamp = log[i].scan.stamp + Duration::from_seconds(60.0);
  }
  const SlamResult result = run_slam(log);
  EXPECT_LT(worst_error(result, whole, 0), 0.1);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("1 gap in time of 60.2 s")));
}

/// What a scanner records that looks backwards from the robot.
std::vector<Observation> record_backwards(const std::vector<Pose2>& path, const Pose2& stated) {
  std::vector<Observation> log = record(ring(), path, 0, 25);
  const Pose2 mounting{-0.2, 0.0, std::numbers::pi};
  for (std::size_t i = 0; i < log.size(); ++i) {
    log[i].scan = test::scan_of(ring(), path[i] * mounting, 0.2 * static_cast<double>(i), 0.01, 25);
    log[i].scan.robot_from_laser = stated;
  }
  return log;
}

TEST(BadInput, AScannerThatLooksBackwardsIsFineWhenTheLogSaysSo) {
  const std::vector<Pose2> path = drive_round(0.1, 11.0);
  const SlamResult result = run_slam(record_backwards(path, {-0.2, 0.0, std::numbers::pi}));
  EXPECT_LT(worst_error(result, path, 0), 0.06);
  EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(BadInput, AScannerThatSecretlyLooksBackwardsIsNoticed) {
  const SlamResult result = run_slam(record_backwards(drive_round(0.1, 11.0), {0.2, 0.0, 0.0}));
  EXPECT_THAT(result.warnings, Contains(HasSubstr("move against odometry")));
}

TEST(BadInput, AScannerThatSecretlyHangsUpsideDownIsNoticed) {
  std::vector<Observation> log = record(ring(), drive_round(0.1, 26.0), 0, 26);
  for (Observation& observation : log) {
    std::reverse(observation.scan.ranges_m.begin(), observation.scan.ranges_m.end());
  }
  EXPECT_THAT(run_slam(log).warnings, Contains(HasSubstr("turn against odometry")));
}

TEST(BadInput, ABaseThatCountsBackwardsAsForwardsIsNoticedAndOverruled) {
  std::vector<Pose2> path = drive_round(0.1, 11.0);
  for (int i = 0; i < 20; ++i) path.push_back(path.back() * Pose2{-0.08, 0.0, 0.0});
  std::vector<Observation> log = record(ring(), path, 0, 29);
  const std::size_t back = log.size() - 20;
  for (std::size_t i = log.size() - 1; i >= back; --i) {
    Pose2 step = between(log[i - 1].odom_from_robot, log[i].odom_from_robot);
    step.x = -step.x;
    log[i].odom_from_robot = step;  // for now the step alone
  }
  for (std::size_t i = back; i < log.size(); ++i) {
    log[i].odom_from_robot = log[i - 1].odom_from_robot * log[i].odom_from_robot;
  }
  const SlamResult result = run_slam(log);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("scans move against odometry, the first at")));
  EXPECT_LT(worst_error(result, path, 0), 0.1);
}

/// A drive along two walls that go on for ever.
std::vector<Observation> record_bare_corridor(const std::vector<Pose2>& path, int run,
                                              std::uint64_t seed) {
  return record({{-60.0, 0.0, 90.0, 0.0}, {-60.0, 2.0, 90.0, 2.0}}, path, run, seed);
}

std::vector<Pose2> straight_on() {
  std::vector<Pose2> path;
  for (int i = 0; i < 120; ++i) path.push_back({0.1 * i, 1.0, 0.0});
  return path;
}

TEST(BadInput, ABareCorridorIsSaidToBeAmbiguousAndLeftToOdometry) {
  const std::vector<Pose2> path = straight_on();
  for (std::uint64_t seed = 130; seed < 134; ++seed) {
    const SlamResult result = run_slam(record_bare_corridor(path, 0, seed));
    EXPECT_THAT(result.warnings, Contains(HasSubstr("leave the position open")));
    const Pose2& last = result.scans.back().map_from_robot;
    EXPECT_NEAR(last.x, path.back().x * 1.03, 0.4);  // 3% is odometry's own error
    EXPECT_NEAR(last.y, 1.0, 0.1);
  }
}

TEST(BadInput, AScannerOfAFewBeamsIsLeftToOdometryAndSaidToBe) {
  const std::vector<Pose2> path = drive_round(0.1, 14.0);
  for (const int beams : {1, 2, 4}) {
    const std::vector<Observation> log = record_with(beams, ring(), path);
    const SlamResult result = run_slam(log);
    EXPECT_THAT(result.warnings, Contains(HasSubstr("hit too little to be matched"))) << beams;
    double max_m = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Pose2 counted = between(log[0].odom_from_robot, log[i].odom_from_robot);
      const Pose2 found = between(result.scans[0].map_from_robot, result.scans[i].map_from_robot);
      max_m = std::max(max_m, translation_distance(found, counted));
    }
    EXPECT_LT(max_m, 0.15) << beams;
  }
}

TEST(BadInput, GivenPosesRuleAlongABareCorridor) {
  const std::vector<Pose2> path = straight_on();
  Slam slam(SlamConfig{});
  for (int run = 0; run < 2; ++run) {
    const auto log = record_bare_corridor(path, run, 28 + static_cast<std::uint64_t>(run));
    for (std::size_t i = 0; i < log.size(); ++i) slam.add(log[i], &path[i]);
  }
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.scans.size(), 2 * path.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    worst = std::max(worst,
                     translation_distance(result.scans[i].map_from_robot, path[i % path.size()]));
  }
  EXPECT_LT(worst, SlamConfig{}.given_poses.stddev_m);
}

/// Out of a room into a hall whose walls nobody sees, and on.
std::vector<Wall> room_before_a_hall() {
  return {{0.0, 0.0, 0.0, 4.0}, {0.0, 0.0, 6.0, 0.0}, {0.0, 4.0, 6.0, 4.0}, {6.0, 0.0, 6.0, 1.2},
          {6.0, 2.8, 6.0, 4.0}, {1.5, 3.0, 2.0, 3.0}, {2.0, 3.0, 2.0, 4.0}};
}

/// In x from `from_m` on, along the middle of that room.
std::vector<Pose2> drive_along_x(double from_m, int scans, double step_m) {
  std::vector<Pose2> path;
  const double heading = step_m < 0.0 ? std::numbers::pi : 0.0;
  for (int i = 0; i < scans; ++i) path.push_back({from_m + step_m * i, 2.0, heading});
  return path;
}

constexpr const char* kHitsNothing = "hit nothing within reach (an open hall?)";

/// Largest difference of a step between two scans from what odometry counted there.
double worst_step(const SlamResult& result, const std::vector<Observation>& log, std::size_t first,
                  std::size_t last) {
  double worst_m = 0.0;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Pose2 found = between(result.scans[i - 1].map_from_robot, result.scans[i].map_from_robot);
    const Pose2 counted = between(log[i - 1].odom_from_robot, log[i].odom_from_robot);
    worst_m = std::max(worst_m, (found.translation() - counted.translation()).norm());
  }
  return worst_m;
}

TEST(BadInput, AHallWithoutWallsInReachIsSaidAndLeftToOdometry) {
  const std::vector<Pose2> path = drive_along_x(1.0, 210, 0.1);
  const std::vector<Observation> log = record(room_before_a_hall(), path, 0, 31);
  const SlamResult result = run_slam(log);
  EXPECT_THAT(result.warnings, ::testing::ElementsAre(HasSubstr(kHitsNothing)));
  ASSERT_EQ(result.scans.size(), path.size());
  EXPECT_LT(worst_step(result, log, 60, path.size()), 1e-3);
  // The room before it is mapped.
  const ReflectionGrid& map = result.filtered;
  const Pose2 map_from_world = result.scans.front().map_from_robot * inverse(path.front());
  EXPECT_TRUE(is_occupied(map.get(map.cell_at(map_from_world * Eigen::Vector2d(3.0, 4.02)))) ||
              is_occupied(map.get(map.cell_at(map_from_world * Eigen::Vector2d(3.0, 3.98)))));
}

TEST(BadInput, ALogThatBeginsInAHallWithoutWallsComesToTheRoomAsOdometryHasIt) {
  const std::vector<Pose2> path = drive_along_x(30.0, 280, -0.1);
  const std::vector<Observation> log = record(room_before_a_hall(), path, 0, 32);
  const SlamResult result = run_slam(log);
  EXPECT_THAT(result.warnings,
              Contains(HasSubstr("the first at 0 s, " + std::string(kHitsNothing))));
  ASSERT_EQ(result.scans.size(), path.size());
  EXPECT_LT(worst_step(result, log, 0, 30), 1e-3);
}

TEST(BadInput, ALogThatHitsNothingHasNoMapAndOdometrysPoses) {
  const std::vector<Pose2> path = drive_along_x(100.0, 60, 0.1);
  const std::vector<Observation> log = record(room_before_a_hall(), path, 0, 33);
  const SlamResult result = run_slam(log);
  EXPECT_THAT(result.warnings, ::testing::ElementsAre(HasSubstr(kHitsNothing)));
  ASSERT_EQ(result.scans.size(), path.size());
  EXPECT_LT(worst_step(result, log, 0, path.size()), 1e-9);
  EXPECT_TRUE(std::none_of(result.filtered.values().begin(), result.filtered.values().end(),
                           [](float m) { return is_occupied(m); }));
}

TEST(BadInput, ARunThatHitsNothingAfterOneThatDidIsLeftOut) {
  std::vector<Observation> log = record(ring(), drive_round(0.1, 8.0), 0, 34);
  const std::size_t first_run = log.size();
  for (Observation& o : record(room_before_a_hall(), drive_along_x(100.0, 20, 0.1), 1, 35)) {
    log.push_back(std::move(o));
  }
  const SlamResult result = run_slam(log);
  EXPECT_EQ(result.scans.size(), first_run);
  EXPECT_THAT(result.unplaced_runs, ::testing::ElementsAre(1));
}

TEST(BadInput, ALoneWallIsSaidToBeAmbiguous) {
  const std::vector<Pose2> path = drive_along_x(0.0, 100, 0.1);
  const SlamResult result = run_slam(record({{-100.0, 4.0, 100.0, 4.0}}, path, 0, 36));
  EXPECT_THAT(result.warnings, Contains(HasSubstr("leave the position open")));
}

}  // namespace
}  // namespace strata::slam
