// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/slam/slam.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

using test::drive_round;
using test::record;
using test::ring;

constexpr double kRoundM = 40.0;

KeepConfig small_window() {
  KeepConfig keep;
  keep.window_scans = 200;
  return keep;
}

/// Drives so many rounds; what is kept after each of them.
struct Kept {
  std::vector<std::size_t> scans;
  std::vector<std::size_t> local_maps;
};
Kept drive(Slam& slam, const std::vector<Observation>& log, std::size_t rounds) {
  Kept kept;
  for (std::size_t i = 0; i < log.size(); ++i) {
    slam.add(log[i]);
    if ((i + 1) % (log.size() / rounds) != 0) continue;
    kept.scans.push_back(slam.kept_scans());
    kept.local_maps.push_back(slam.kept_local_maps());
  }
  return kept;
}

TEST(Keep, RoundAndRoundOneBlockKeepsNoMoreThanThreeRounds) {
  constexpr std::size_t kRounds = 12;
  const std::vector<Pose2> path = drive_round(0.1, kRounds * kRoundM);
  Slam slam(SlamConfig{}, 1, small_window());
  const Kept kept = drive(slam, record(ring(), path, 0, 1), kRounds);
  ASSERT_GE(kept.scans.size(), kRounds);
  // What the first views take; later ones replace them.
  const std::size_t most = kept.scans[3] + 200;
  for (std::size_t round = 4; round < kept.scans.size(); ++round) {
    EXPECT_LE(kept.scans[round], most) << round;
    EXPECT_LE(kept.local_maps[round], kept.local_maps[3] + 4) << round;
  }
  // The map is still the block's, and the poses in it are where they were driven.
  const SlamResult result = slam.finish();
  std::vector<Pose2> found;
  std::vector<Pose2> truth;
  for (const PosedScan& scan : result.scans) {
    found.push_back(scan.map_from_robot);
    truth.push_back(path[static_cast<std::size_t>(scan.scan.stamp.seconds() / 0.2 + 0.5)]);
  }
  const Pose2 truth_from_map = align(found, truth);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT(translation_distance(truth_from_map * found[i], truth[i]), 0.08) << i;
  }
}

TEST(Keep, ARobotThatStandsStillKeepsTheWindowAlone) {
  const std::vector<Pose2> path(2'000, Pose2{3.0, 1.0, 0.0});
  Slam slam(SlamConfig{}, 1, small_window());
  for (const Observation& observation : record(ring(), path, 0, 2)) {
    slam.add(observation);
    ASSERT_LE(slam.kept_scans(), 200U + 64U + 10U);
  }
  EXPECT_EQ(slam.kept_local_maps(), 0U);
}

TEST(Keep, ALogThatFitsIntoTheWindowGivesTheResultOfKeepingAll) {
  const std::vector<Observation> log = record(ring(), drive_round(0.1, 20.0), 0, 3);
  KeepConfig keep;
  keep.window_scans = static_cast<int>(log.size());
  Slam bounded(SlamConfig{}, 1, keep);
  for (const Observation& observation : log) bounded.add(observation);
  const SlamResult one = bounded.finish();
  const SlamResult all = test::run_slam(log);
  ASSERT_EQ(one.scans.size(), all.scans.size());
  for (std::size_t i = 0; i < all.scans.size(); ++i) {
    ASSERT_EQ(one.scans[i].map_from_robot, all.scans[i].map_from_robot);
  }
}

TEST(Keep, PlacesThatAreNotSeenAgainStay) {
  // One way along the corridor, then to and fro at its end.
  std::vector<Pose2> path = drive_round(0.1, 24.0);
  const std::size_t until = path.size();
  for (int lap = 0; lap < 14; ++lap) {
    for (int i = 0; i < 40; ++i) {
      path.push_back(path.back() * Pose2{lap % 2 == 0 ? -0.1 : 0.1, 0.0, 0.0});
    }
  }
  Slam slam(SlamConfig{}, 1, small_window());
  for (const Observation& observation : record(ring(), path, 0, 4)) slam.add(observation);
  EXPECT_LT(slam.kept_scans(), path.size());
  const SlamResult result = slam.finish();
  // The beginning, in whose local map nobody was since, is still there, scan by scan.
  ASSERT_GT(result.scans.size(), 50U);
  std::size_t of_the_way = 0;
  for (const PosedScan& scan : result.scans) {
    of_the_way += scan.scan.stamp.seconds() < 0.2 * static_cast<double>(until) ? 1 : 0;
  }
  EXPECT_GT(of_the_way, until / 2);
  EXPECT_TRUE(is_free(result.occupancy.get(result.occupancy.cell_at({6.0, 1.0}))));
}

/// What a robot records that was carried into another building.
std::vector<Observation> elsewhere(int run, double begin_s) {
  std::vector<Pose2> path;
  for (int i = 0; i < 60; ++i) path.push_back({3.0 + 0.05 * i, 3.0, 0.0});
  std::vector<Observation> log = record(test::room(), path, run, 8);
  for (Observation& observation : log) {
    observation.scan.stamp = observation.scan.stamp + Duration::from_seconds(begin_s);
  }
  return log;
}

TEST(Keep, ARunThatEndedWithoutAPlaceGoesAsAWholeWithTheWindow) {
  Slam slam(SlamConfig{}, 1, small_window());
  const std::vector<Pose2> path = drive_round(0.1, 45.0);
  const std::vector<Observation> first = record(ring(), path, 0, 7);
  for (const Observation& observation : first) slam.add(observation);
  const std::size_t of_the_map = slam.kept_scans();
  constexpr int kRuns = 12;
  std::size_t most_local_maps = 0;
  for (int run = 1; run <= kRuns; ++run) {
    const auto log = elsewhere(run, 1'000.0 * run);
    for (const Observation& observation : log) slam.add(observation);
    // The window, and the run that leaves it.
    EXPECT_LE(slam.kept_scans(), of_the_map + 200U + 2U * log.size()) << run;
    if (run == 6) most_local_maps = slam.kept_local_maps();
    if (run > 6) {
      EXPECT_LE(slam.kept_local_maps(), most_local_maps) << run;
    }
  }
  ASSERT_GE(slam.forgotten_unplaced().runs, 6U);
  EXPECT_EQ(slam.forgotten_unplaced().scans % slam.forgotten_unplaced().runs, 0U) << "whole runs";
  // The newest ones may still be placed by who looks for them, and the map is as it was.
  const SlamResult result = slam.finish();
  EXPECT_FALSE(result.unplaced_runs.empty());
  EXPECT_GT(result.scans.size(), 100U);
  for (const PosedScan& scan : result.scans) EXPECT_EQ(scan.run, 0);
}

TEST(Keep, ThePlacesWhereRunsBeganGoWithTheirScans) {
  Slam slam(SlamConfig{}, 1, small_window());
  const std::vector<Observation> log =
      record(ring(), std::vector<Pose2>(1'600, Pose2{3.0, 1.0, 0.0}), 0, 2);
  constexpr std::size_t kScansOfARun = 4;
  // Local maps come and go: the least over many runs tells what stays.
  std::size_t least[2] = {SIZE_MAX, SIZE_MAX};
  for (std::size_t i = 0; i < log.size(); ++i) {
    Observation observation = log[i];
    observation.run = static_cast<int>(i / kScansOfARun);
    if (i % kScansOfARun == 0 && i > 0) {
      slam.begin_next_run_at({slam.newest()->map_from_robot, 0.01 * Eigen::Matrix3d::Identity()});
    }
    slam.add(observation);
    if (i % kScansOfARun != kScansOfARun - 1) continue;
    const int run = observation.run % 200;
    if (run < 180) continue;
    std::size_t& bytes = least[observation.run / 200];
    bytes = std::min(bytes, slam.save_state().size());
  }
  EXPECT_LE(least[1], least[0] + 10'000U) << "two hundred runs on";
}

TEST(Keep, RefusesSharesThatKeepNothing) {
  KeepConfig keep;
  keep.own_share = 1.0;
  EXPECT_THROW(Slam(SlamConfig{}, 1, keep), ConfigError);
}

}  // namespace
}  // namespace strata::slam
