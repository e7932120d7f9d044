// SPDX-License-Identifier: Apache-2.0
/// A mapping robot whose process is stopped and goes on from its saved state.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "core/slam/slam.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

using test::drive_round;
using test::record;
using test::ring;

KeepConfig window(int scans) {
  KeepConfig keep;
  keep.window_scans = scans;
  return keep;
}

/// Adds the whole log; every `stop_every` scans everything is saved and restored into a new object.
/// The poses that `add` gave, and what `finish` made.
std::pair<std::vector<Pose2>, SlamResult> live(const std::vector<Observation>& log,
                                               std::size_t stop_every, const KeepConfig& keep) {
  auto slam = std::make_unique<Slam>(SlamConfig{}, 1, keep);
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < log.size(); ++i) {
    poses.push_back(slam->add(log[i]).mean);
    if ((i + 1) % stop_every != 0) continue;
    const std::vector<std::uint8_t> state = slam->save_state();
    slam = std::make_unique<Slam>(SlamConfig{}, 1, keep);
    slam->restore_state(state, "state");
  }
  return {poses, slam->finish()};
}

TEST(SavedSlam, StoppedAgainAndAgainItMapsAsIfItHadNeverStopped) {
  // Round the block more than once, so that loops close and local maps are forgotten, in two runs.
  std::vector<Observation> log = record(ring(), drive_round(0.1, 90.0), 0, 1);
  const std::vector<Observation> second = record(ring(), drive_round(0.1, 30.0), 1, 2);
  log.insert(log.end(), second.begin(), second.end());
  // The last metres without odometry.
  for (std::size_t i = log.size() - 100; i < log.size(); ++i) log[i].has_odometry = false;
  for (const KeepConfig& keep : {KeepConfig{}, window(200)}) {
    const auto [poses, result] = live(log, log.size() + 1, keep);
    const auto [stopped_poses, stopped] = live(log, 37, keep);
    EXPECT_EQ(stopped_poses, poses);
    ASSERT_EQ(stopped.scans.size(), result.scans.size());
    for (std::size_t i = 0; i < result.scans.size(); ++i) {
      ASSERT_EQ(stopped.scans[i].map_from_robot, result.scans[i].map_from_robot) << i;
      ASSERT_EQ(stopped.scans[i].static_probability, result.scans[i].static_probability) << i;
    }
    EXPECT_EQ(stopped.loop_closures, result.loop_closures);
    EXPECT_GT(result.loop_closures, 0U);
    EXPECT_EQ(stopped.log_likelihood, result.log_likelihood);
    EXPECT_EQ(stopped.warnings, result.warnings);
  }
}

TEST(SavedSlam, TheNewestScanIsToldAsItWasPosed) {
  const std::vector<Observation> log = record(ring(), drive_round(0.1, 50.0), 3, 1);
  Slam slam{SlamConfig{}};
  EXPECT_FALSE(slam.newest());
  Pose2 pose;
  for (const Observation& observation : log) pose = slam.add(observation).mean;
  Slam again{SlamConfig{}};
  again.restore_state(slam.save_state(), "state");
  const auto newest = again.newest();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->run, 3);
  EXPECT_EQ(newest->stamp, log.back().scan.stamp);
  EXPECT_EQ(newest->odom_from_robot, log.back().odom_from_robot);
  EXPECT_LT(translation_distance(newest->map_from_robot, pose), 0.05) << "a loop may have closed";
}

TEST(SavedSlam, ARunThatBeginsWhereTheLastOneEndedIsToldFromThere) {
  const std::vector<Pose2> path = drive_round(0.1, 60.0);
  std::vector<Observation> log = record(ring(), path, 0, 1);
  Slam slam{SlamConfig{}};
  const std::size_t half = log.size() / 2;
  for (std::size_t i = 0; i < half; ++i) slam.add(log[i]);
  Slam again{SlamConfig{}};
  again.restore_state(slam.save_state(), "state");
  again.begin_next_run_at(
      {again.newest()->map_from_robot, Eigen::Vector3d(0.09, 0.09, 0.01).asDiagonal()});
  // The odometry has begun anew.
  const Pose2 start = log[half].odom_from_robot;
  std::vector<Pose2> found;
  for (std::size_t i = half; i < log.size(); ++i) {
    log[i].run = 1;
    log[i].odom_from_robot = between(start, log[i].odom_from_robot);
    found.push_back(again.add(log[i]).mean);
  }
  EXPECT_LT(translation_distance(found.front(), slam.newest()->map_from_robot), 0.2);
  const Pose2 truth = between(path[half], path.back());
  const Pose2 moved = between(found.front(), found.back());
  EXPECT_LT(translation_distance(moved, truth), 0.3);
  EXPECT_TRUE(again.finish().unplaced_runs.empty());
}

TEST(SavedSlam, RefusesBytesThatAreCutOrOfAnotherResolution) {
  Slam slam{SlamConfig{}};
  for (const Observation& observation : record(ring(), drive_round(0.1, 20.0), 0, 1)) {
    slam.add(observation);
  }
  const std::vector<std::uint8_t> state = slam.save_state();
  RandomStream random(1, StreamId::kTest, 0);
  for (int i = 0; i < 30; ++i) {
    const auto length =
        static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(state.size())));
    Slam again{SlamConfig{}};
    EXPECT_THROW(again.restore_state(std::span(state).first(length), "state"), InputError);
  }
  SlamConfig coarse;
  coarse.beam_filter.resolution_m = 0.1;
  Slam other(coarse);
  EXPECT_THROW(other.restore_state(state, "state"), InputError);
}

}  // namespace
}  // namespace strata::slam
