// SPDX-License-Identifier: Apache-2.0
/// SLAM with odometry that comes late, comes back, or is not there.
#include <vector>

#include <gtest/gtest.h>

#include "core/slam/slam.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

using test::drive_round;
using test::record;
using test::ring;
using test::run_slam;
using test::worst_error;

TEST(Slam, WorksWithoutOdometry) {
  const std::vector<Pose2> path = drive_round(0.1, 20.0);
  std::vector<Observation> log = record(ring(), path, 0, 4);
  for (Observation& observation : log) {
    observation.has_odometry = false;
    observation.odom_from_robot = {};
  }
  const SlamResult result = run_slam(log);
  ASSERT_EQ(result.scans.size(), path.size());
  // Without odometry the map begins at the first pose.
  std::vector<Pose2> truth;
  for (const Pose2& pose : path) truth.push_back(between(path.front(), pose));
  EXPECT_LT(worst_error(result, truth, 0), 0.1);
}

// As on a robot whose odometry is first heard when it drives already.
TEST(Slam, OdometryThatComesLateMovesNothing) {
  const std::vector<Pose2> path = drive_round(0.1, 20.0);
  std::vector<Observation> log = record(ring(), path, 0, 4);
  constexpr std::size_t kBlind = 60;
  const Pose2 elsewhere{30.0, -20.0, 2.0};
  for (std::size_t i = 0; i < log.size(); ++i) {
    log[i].has_odometry = i >= kBlind;
    log[i].odom_from_robot = log[i].has_odometry ? elsewhere * log[i].odom_from_robot : Pose2{};
  }
  Slam slam(SlamConfig{});
  for (std::size_t i = 0; i < log.size(); ++i) {
    const Pose2Gaussian found = slam.add(log[i]);
    EXPECT_LT(translation_distance(found.mean, between(path.front(), path[i])), 0.15) << i;
  }
}

// What the scans of a gap were matched to lies in the motion that odometry tells after it.
TEST(Slam, OdometryThatComesBackDoesNotAddTheGapAgain) {
  const std::vector<Pose2> path = drive_round(0.1, 20.0);
  for (const std::size_t begin : {40U, 60U, 80U, 100U, 120U}) {
    for (const std::size_t length : {6U, 12U, 18U}) {
      SCOPED_TRACE(testing::Message() << begin << " + " << length);
      std::vector<Observation> log = record(ring(), path, 0, 4);
      for (std::size_t i = begin; i < begin + length; ++i) {
        log[i].has_odometry = false;
        log[i].odom_from_robot = {};
      }
      Slam slam(SlamConfig{});
      double worst_m = 0.0;
      for (std::size_t i = 0; i < log.size(); ++i) {
        const Pose2 truth = log[0].odom_from_robot * between(path.front(), path[i]);
        worst_m = std::max(worst_m, translation_distance(slam.add(log[i]).mean, truth));
      }
      EXPECT_LT(worst_m, 0.25);
    }
  }
}

TEST(Slam, WorksWithoutOdometryWhereStampsAreThoseOfDelivery) {
  // Five scans at once, then none for a second; and a clock that was set back mixes the scans of
  // two places in order of time.
  const std::vector<Pose2> path = drive_round(0.1, 20.0);
  std::vector<Observation> log = record(ring(), path, 0, 6);
  std::vector<Pose2> truth = path;
  for (std::size_t i = 58; i < 64; i += 2) {
    std::swap(log[i], log[i + 5]);
    std::swap(truth[i], truth[i + 5]);
  }
  for (std::size_t i = 0; i < log.size(); ++i) {
    log[i].has_odometry = false;
    log[i].odom_from_robot = {};
    log[i].scan.stamp =
        Stamp::from_seconds(1.0 * static_cast<double>(i / 5) + 0.002 * static_cast<double>(i % 5));
  }
  const SlamResult result = run_slam(log);
  ASSERT_EQ(result.scans.size(), path.size());
  EXPECT_LT(worst_error(result, truth, 0), 0.15);
}

}  // namespace
}  // namespace strata::slam
