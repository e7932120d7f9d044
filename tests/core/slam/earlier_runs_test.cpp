// SPDX-License-Identifier: Apache-2.0
// A new log in the map of runs that were learned before.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/slam/slam.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

using test::drive_round;
using test::record;
using test::ring;
using test::run_slam;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The same drive, as so many runs that were placed. Each lacks scans in the middle, which were
/// forgotten, and what is odd about them was told when they were learned.
void add_earlier_runs(Slam& slam, const SlamResult& learned, int runs, std::size_t forgotten) {
  const std::size_t middle = learned.scans.size() / 2;
  for (int run = 0; run < runs; ++run) {
    for (std::size_t i = 0; i < learned.scans.size(); ++i) {
      if (i >= middle && i < middle + forgotten) continue;
      PosedScan scan = learned.scans[i];
      scan.run = run;
      slam.add_placed(scan);
    }
  }
}

void add_new_run(Slam& slam, const std::vector<Observation>& log, int run) {
  for (Observation observation : log) {
    observation.run = run;
    slam.add(observation);
  }
}

TEST(EarlierRuns, DoNotHideThatANewLogIsOdd) {
  const SlamResult learned = run_slam(record(ring(), drive_round(0.1, 26.0), 0, 31));
  std::vector<Observation> log = record(ring(), drive_round(0.1, 26.0), 0, 32);
  for (Observation& observation : log) {
    std::reverse(observation.scan.ranges_m.begin(), observation.scan.ranges_m.end());
  }
  Slam slam(SlamConfig{}, 2);
  add_earlier_runs(slam, learned, 4, 0);
  add_new_run(slam, log, 4);
  EXPECT_THAT(slam.finish().warnings, Contains(HasSubstr("turn against odometry")));
}

TEST(EarlierRuns, OfWhichScansWereForgottenAreNothingToWarnOf) {
  const std::vector<Observation> log = record(ring(), drive_round(0.1, 15.0), 0, 33);
  const SlamResult learned = run_slam(log);
  Slam slam(SlamConfig{}, 2);
  add_earlier_runs(slam, learned, 2, 70);  // 14 s
  add_new_run(slam, log, 2);
  EXPECT_THAT(slam.finish().warnings, IsEmpty());
}

TEST(EarlierRuns, AreNotMatchedWithEachOtherAgain) {
  const std::vector<Observation> log = record(ring(), drive_round(0.1, 60.0), 0, 34);
  const SlamResult learned = run_slam(log);
  ASSERT_GT(learned.loop_closures, 0U);
  Slam placed(SlamConfig{}, 2);
  add_earlier_runs(placed, learned, 3, 0);
  EXPECT_EQ(placed.finish().loop_closures, 0U);
  Slam slam(SlamConfig{}, 2);
  add_earlier_runs(slam, learned, 3, 0);
  add_new_run(slam, log, 3);
  const SlamResult all = slam.finish();
  EXPECT_GT(all.loop_closures, 0U);
  // The new run lies in the map of the others.
  for (std::size_t i = 0; i < log.size(); ++i) {
    const PosedScan& scan = all.scans[3 * log.size() + i];
    ASSERT_EQ(scan.run, 3);
    ASSERT_LT(translation_distance(scan.map_from_robot, learned.scans[i].map_from_robot), 0.05);
  }
}

}  // namespace
}  // namespace strata::slam
