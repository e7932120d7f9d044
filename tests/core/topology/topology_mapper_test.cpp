// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_mapper.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/slam/ring_world.hpp"

namespace strata::topology {
namespace {

constexpr double kStepM = 0.02;
constexpr std::size_t kStands = 200;  // scans

/// Ten metres of the way round the block, and then on one spot.
std::vector<Observation> drive_and_stand() {
  std::vector<Pose2> path = test::drive_round(kStepM, 10.0);
  path.insert(path.end(), kStands, path.back());
  return test::record(test::ring(), path, 0, 3);
}

TEST(TopologyMapper, KeepsEveryScanUnlessItIsToldOtherwise) {
  const std::vector<Observation> log = drive_and_stand();
  TopologyMapper mapper(TopologyMapperConfig{});
  for (const Observation& seen : log) (void)mapper.add(seen);
  EXPECT_EQ(mapper.scans().size(), log.size());
  EXPECT_FALSE(mapper.is_full());
}

TEST(TopologyMapper, KeepsScansThatLieApartAndTracksTheOthersToo) {
  const std::vector<Observation> log = drive_and_stand();
  TopologyMapper mapper(TopologyMapperConfig{}, 1, 1, {.subsample_m = 0.1, .subsample_rad = 0.2});
  for (std::size_t i = 0; i + kStands < log.size(); ++i) (void)mapper.add(log[i]);
  const std::size_t kept = mapper.scans().size();
  // Every fifth: what is rounded or turned may add or take one now and then.
  EXPECT_NEAR(static_cast<double>(kept), 10.0 / 0.1, 20.0);
  for (std::size_t i = 1; i < kept; ++i) {
    const Pose2 step =
        between(mapper.scans()[i - 1].map_from_robot, mapper.scans()[i].map_from_robot);
    EXPECT_TRUE(step.translation().norm() >= 0.1 || std::abs(step.theta) >= 0.2) << i;
    EXPECT_LT(step.translation().norm(), 0.2) << "a scan in between was lost";
  }
  for (std::size_t i = log.size() - kStands; i < log.size(); ++i) (void)mapper.add(log[i]);
  EXPECT_LE(mapper.scans().size(), kept + 1) << "it stands";
  EXPECT_EQ(mapper.skipped_scans(), 0U);
  (void)mapper.add(log[log.size() - 2]);
  EXPECT_EQ(mapper.skipped_scans(), 1U) << "older than one that was not kept";
}

// As on a robot whose odometry is first heard when it drives already, or is lost for a while.
TEST(TopologyMapper, OdometryThatComesLateOrIsMissedOnceMovesNothing) {
  const std::vector<Pose2> path = test::drive_round(0.1, 10.0);
  std::vector<Observation> log = test::record(test::ring(), path, 0, 3);
  constexpr std::size_t kBlind = 20;
  const Pose2 elsewhere{30.0, -20.0, 2.0};
  for (std::size_t i = 0; i < log.size(); ++i) {
    log[i].has_odometry = i >= kBlind && i != 50;
    log[i].odom_from_robot = log[i].has_odometry ? elsewhere * log[i].odom_from_robot : Pose2{};
  }
  for (const bool matches : {true, false}) {
    SCOPED_TRACE(matches ? "matched" : "by odometry alone");
    TopologyMapperConfig config;
    config.match_scans = matches;
    TopologyMapper mapper(config);
    for (const Observation& seen : log) (void)mapper.add(seen);
    ASSERT_EQ(mapper.scans().size(), log.size());
    for (std::size_t i = 1; i < log.size(); ++i) {
      const Pose2 step =
          between(mapper.scans()[i - 1].map_from_robot, mapper.scans()[i].map_from_robot);
      EXPECT_LT(step.translation().norm(), 0.3) << i;
    }
    const Pose2 driven = between(path[kBlind], path.back());
    const Pose2 found =
        between(mapper.scans()[kBlind].map_from_robot, mapper.scans().back().map_from_robot);
    EXPECT_NEAR(found.translation().norm(), driven.translation().norm(), 0.6);
  }
}

TEST(TopologyMapper, TakesNoMoreOnceItsMemoryIsUsedUpAlsoAfterARestart) {
  const std::vector<Observation> log = drive_and_stand();
  const std::size_t bytes = sizeof(PosedScan) + log.front().scan.ranges_m.size() * sizeof(float);
  const PathKeepConfig keep{.memory_mb = static_cast<double>(100 * bytes) * 1e-6};
  TopologyMapper mapper(TopologyMapperConfig{}, 1, 1, keep);
  for (const Observation& seen : log) (void)mapper.add(seen);
  EXPECT_EQ(mapper.scans().size(), 100U);
  EXPECT_TRUE(mapper.is_full());
  EXPECT_EQ(mapper.skipped_scans(), log.size() - 100);
  TopologyMapper again(TopologyMapperConfig{}, 1, 1, keep);
  for (const PosedScan& scan : mapper.scans()) (void)again.restore(scan);
  (void)again.add(log.back());
  EXPECT_EQ(again.scans().size(), 100U);
  EXPECT_EQ(again.skipped_scans(), 1U);
}

}  // namespace
}  // namespace strata::topology
