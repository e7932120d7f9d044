// SPDX-License-Identifier: Apache-2.0
#include "core/slam/slam.hpp"

#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

using test::drive_round;
using test::record;
using test::ring;
using test::run_slam;
using test::worst_error;

TEST(Slam, ClosesALoopThatOdometryMissesByMetres) {
  const std::vector<Pose2> path = drive_round(0.1, 50.0);
  const std::vector<Observation> log = record(ring(), path, 0, 1);
  EXPECT_GT(translation_distance(log.back().odom_from_robot, path.back()), 3.0);
  const SlamResult result = run_slam(log);
  ASSERT_EQ(result.scans.size(), path.size());
  EXPECT_GT(result.loop_closures, 0U);
  EXPECT_LT(worst_error(result, path, 0), 0.06);
  EXPECT_EQ(result.skipped_scans, 0U);
  EXPECT_TRUE(result.unplaced_runs.empty());
  // The map: a wall cell is occupied, the middle of the corridor is free, the block is unknown.
  EXPECT_TRUE(is_free(result.occupancy.get(result.occupancy.cell_at({6.0, 1.0}))));
  EXPECT_FALSE(is_known(result.occupancy.get(result.occupancy.cell_at({7.0, 5.0}))));
}

TEST(Slam, EmRaisesTheLogLikelihoodAndReturnsTheBestRound) {
  const SlamResult result = run_slam(record(ring(), drive_round(0.1, 45.0), 0, 2));
  ASSERT_GE(result.log_likelihood.size(), 2U);
  const auto best = std::max_element(result.log_likelihood.begin(), result.log_likelihood.end());
  EXPECT_EQ(best - result.log_likelihood.begin(), result.iterations);
  EXPECT_GT(*best, result.log_likelihood.front());
}

TEST(Slam, GivesTheSameBitsForAnyNumberOfThreads) {
  const std::vector<Observation> log = record(ring(), drive_round(0.15, 45.0), 0, 3);
  const SlamResult one = run_slam(log, 1);
  for (const int threads : {2, 8}) {
    const SlamResult other = run_slam(log, threads);
    ASSERT_EQ(other.scans.size(), one.scans.size());
    for (std::size_t i = 0; i < one.scans.size(); ++i) {
      ASSERT_EQ(other.scans[i].map_from_robot, one.scans[i].map_from_robot);
      ASSERT_EQ(other.scans[i].static_probability, one.scans[i].static_probability);
    }
    ASSERT_EQ(other.log_likelihood, one.log_likelihood);
    ASSERT_EQ(other.raw.cells().rect(), one.raw.cells().rect());
    const Grid<CellCounts> others = other.raw.cells().dense();
    const Grid<CellCounts> ones = one.raw.cells().dense();
    for (std::size_t i = 0; i < ones.size(); ++i) {
      ASSERT_EQ(others.values()[i].hits, ones.values()[i].hits);
      ASSERT_EQ(others.values()[i].misses, ones.values()[i].misses);
    }
  }
}

TEST(Slam, BeginsALocalMapAfterTenMetresHoweverFewScansTheyHold) {
  // Scans a metre apart: by their number alone one local map would hold 80 m, whose drift no loop
  // closure could mend.
  const std::vector<Pose2> path = drive_round(1.0, 90.0);
  const std::vector<Observation> log = record(ring(), path, 0, 5);
  ASSERT_LT(log.size(), 190U);
  Slam slam(SlamConfig{});
  for (const Observation& observation : log) slam.add(observation);
  // All but the two under construction.
  EXPECT_GE(slam.kept_local_maps(), 7U);
  EXPECT_LT(worst_error(slam.finish(), path, 0), 0.15);
}

TEST(Slam, FindsALaterRunInTheMapOfTheFirst) {
  const std::vector<Pose2> first = drive_round(0.1, 45.0);
  const std::vector<Pose2> all = drive_round(0.1, 40.0);
  const std::vector<Pose2> second(all.begin() + 170, all.end());
  std::vector<Observation> log = record(ring(), first, 0, 5);
  std::vector<Observation> later = record(ring(), second, 1, 6);
  // Its odometry begins at zero, and its stamps overlap those of the first run.
  const Pose2 shift = inverse(later.front().odom_from_robot);
  for (Observation& observation : later) {
    observation.odom_from_robot = shift * observation.odom_from_robot;
    log.push_back(observation);
  }
  const SlamResult result = run_slam(log);
  EXPECT_TRUE(result.unplaced_runs.empty());
  ASSERT_EQ(result.scans.size(), first.size() + second.size());
  EXPECT_LT(worst_error(result, first, 0), 0.06);
  EXPECT_LT(worst_error(result, second, 1), 0.06);
}

TEST(Slam, LeavesOutARunFromAnotherBuilding) {
  std::vector<Observation> log = record(ring(), drive_round(0.1, 45.0), 0, 7);
  const std::size_t first_scans = log.size();
  std::vector<Pose2> elsewhere;
  for (int i = 0; i < 60; ++i) elsewhere.push_back({3.0 + 0.05 * i, 3.0, 0.0});
  for (const Observation& observation : record(test::room(), elsewhere, 1, 8)) {
    log.push_back(observation);
  }
  const SlamResult result = run_slam(log);
  EXPECT_EQ(result.scans.size(), first_scans);
  EXPECT_EQ(result.unplaced_runs, std::vector<int>{1});
}

TEST(Slam, KeepsGivenPosesOfASingleRunToTheBit) {
  const std::vector<Pose2> path = drive_round(0.1, 10.0);
  const std::vector<Observation> log = record(ring(), path, 0, 9);
  Slam slam(SlamConfig{});
  for (std::size_t i = 0; i < log.size(); ++i) {
    EXPECT_EQ(slam.add(log[i], &path[i]).mean, path[i]);
  }
  const SlamResult result = slam.finish();
  for (std::size_t i = 0; i < path.size(); ++i) {
    ASSERT_EQ(result.scans[i].map_from_robot, path[i]);
    ASSERT_EQ(result.scans[i].static_probability.size(), log[i].scan.size());
  }
}

TEST(Slam, RefinesGivenPosesOfSeveralRunsUntilTheirWallsCoincide) {
  const std::vector<Pose2> path = drive_round(0.1, 38.0);
  Slam slam(SlamConfig{});
  for (int run = 0; run < 3; ++run) {
    const std::vector<Observation> log =
        record(ring(), path, run, 10 + static_cast<std::uint64_t>(run));
    const Pose2 off{0.08 * run, -0.06 * run, 0.004 * run};
    for (std::size_t i = 0; i < log.size(); ++i) {
      const Pose2 given = path[i] * off;
      slam.add(log[i], &given);
    }
  }
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.scans.size(), 3 * path.size());
  double apart = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    for (std::size_t run = 1; run < 3; ++run) {
      apart += translation_distance(result.scans[i].map_from_robot,
                                    result.scans[run * path.size() + i].map_from_robot);
    }
  }
  EXPECT_LT(apart / static_cast<double>(2 * path.size()), 0.02);
}

TEST(Slam, PlacesALaterRunAmongScansWhosePosesAreFinal) {
  const std::vector<Pose2> first = drive_round(0.1, 45.0);
  const std::vector<Pose2> all = drive_round(0.1, 40.0);
  const std::vector<Pose2> second(all.begin() + 170, all.end());
  const SlamResult before = run_slam(record(ring(), first, 0, 5));
  std::vector<Observation> later = record(ring(), second, 1, 6);
  const Pose2 shift = inverse(later.front().odom_from_robot);
  Slam slam(SlamConfig{});
  for (const PosedScan& scan : before.scans) slam.add_placed(scan);
  for (Observation& observation : later) {
    observation.odom_from_robot = shift * observation.odom_from_robot;
    slam.add(observation);
  }
  const SlamResult result = slam.finish();
  EXPECT_TRUE(result.unplaced_runs.empty());
  ASSERT_EQ(result.scans.size(), first.size() + second.size());
  for (std::size_t i = 0; i < before.scans.size(); ++i) {
    ASSERT_EQ(result.scans[i].map_from_robot, before.scans[i].map_from_robot) << i;
  }
  EXPECT_LT(worst_error(result, second, 1), 0.06);
}

TEST(Slam, SkipsAndCountsScansThatSayNothingOrComeFromThePast) {
  const std::vector<Pose2> path = drive_round(0.1, 6.0);
  std::vector<Observation> log = record(ring(), path, 0, 11);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Observation> bad(5, log[20]);
  std::fill(bad[0].scan.ranges_m.begin(), bad[0].scan.ranges_m.end(), kNan);
  bad[1].scan.ranges_m.clear();
  bad[2].scan.stamp = log[3].scan.stamp;
  bad[3].odom_from_robot.x = std::numeric_limits<double>::quiet_NaN();
  bad[4].odom_from_robot.theta = std::numeric_limits<double>::infinity();
  const SlamResult clean = run_slam(log);
  log.insert(log.begin() + 21, bad.begin(), bad.end());
  const SlamResult result = run_slam(log);
  EXPECT_EQ(result.skipped_scans, 5U);
  ASSERT_EQ(result.scans.size(), clean.scans.size());
  for (std::size_t i = 0; i < clean.scans.size(); ++i) {
    ASSERT_EQ(result.scans[i].map_from_robot, clean.scans[i].map_from_robot);
  }
}

TEST(Slam, AnEmptyLogGivesAnEmptyResult) {
  Slam slam(SlamConfig{});
  const SlamResult result = slam.finish();
  EXPECT_TRUE(result.scans.empty());
  EXPECT_EQ(result.skipped_scans, 0U);
}

class CancelAtOnce final : public Progress {
 public:
  void update(std::string_view, std::size_t, std::size_t) override {}
  [[nodiscard]] bool cancelled() const override { return true; }
};

TEST(Slam, StopsWhenTheUserAsks) {
  Slam slam(SlamConfig{});
  for (const Observation& observation : record(ring(), drive_round(0.1, 6.0), 0, 12)) {
    slam.add(observation);
  }
  CancelAtOnce progress;
  EXPECT_THROW(static_cast<void>(slam.finish(&progress)), Cancelled);
}

TEST(Slam, RefusesASettingThatCannotWork) {
  SlamConfig config;
  config.beam_filter.prior = 0.4;
  EXPECT_THROW(Slam{config}, ConfigError);
  config = {};
  config.tracking.match.levels = 0;
  EXPECT_THROW(Slam{config}, ConfigError);
}

/// The drive as a scanner of so many beams all round sees it.
std::vector<Observation> record_with(int beams, const std::vector<Pose2>& path) {
  std::vector<Observation> log = record(ring(), path, 0, 30);
  for (std::size_t i = 0; i < path.size(); ++i) {
    log[i].scan = test::scan_of(ring(), path[i], 0.2 * static_cast<double>(i), 0.01, 30, beams,
                                2.0 * std::numbers::pi);
  }
  return log;
}

TEST(Slam, MapsWithFourThousandBeamsAllRound) {
  const std::vector<Pose2> path = drive_round(0.1, 14.0);
  const SlamResult result = run_slam(record_with(4'000, path));
  ASSERT_EQ(result.scans.size(), path.size());
  EXPECT_EQ(result.scans.back().static_probability.size(), 4'000U);
  EXPECT_LT(worst_error(result, path, 0), 0.03);
  EXPECT_LT(result.dynamic_fraction, 0.02);
  EXPECT_TRUE(result.warnings.empty());
}

}  // namespace
}  // namespace strata::slam
