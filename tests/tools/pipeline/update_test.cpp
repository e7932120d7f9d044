// SPDX-License-Identifier: Apache-2.0
/// Going on from maps learned before, as `learn --update` does.
#include <algorithm>

#include <gtest/gtest.h>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "memory/store/store.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"
#include "tools/pipeline/learn.hpp"

namespace strata::pipeline {
namespace {

constexpr std::uint64_t kSeed = 5;

std::vector<Observation> of_days(const Runs& runs, int first, int end) {
  std::vector<Observation> part;
  for (const Observation& observation : runs.observations) {
    if (observation.run >= first && observation.run < end) part.push_back(observation);
  }
  return part;
}

/// Two days learned and written to a folder; the third is still to come.
class Update : public testing::Test {
 protected:
  void SetUp() override {
    before = learn(of_days(runs, 0, 2), {}, {}, {}, kSeed, 2, nullptr);
    maps::write_grid_maps(folder.path(), before.slam);
    maps::write_timescale(folder.path(), *before.timescale);
    maps::write_map_from_truth(folder.path(), {1.0, 2.0, 0.5});
    maps::write_summary(folder.path(), "monday tuesday", {});
  }
  [[nodiscard]] LearnResult go_on() const {
    maps::EarlierRuns earlier = maps::read_earlier_runs(folder.path());
    return learn(of_days(runs, 2, 3), {}, {}, {}, kSeed, 2, nullptr, &earlier);
  }
  const Runs runs = test_room::simulate_runs(kSeed, 3);
  const test::TemporaryDirectory folder;
  LearnResult before;
};

TEST_F(Update, ReadsBackWhatLearningLeft) {
  const maps::EarlierRuns earlier = maps::read_earlier_runs(folder.path());
  EXPECT_EQ(earlier.log, "monday tuesday");
  EXPECT_EQ(earlier.next_run, 2);
  EXPECT_EQ(earlier.map_from_truth, (Pose2{1.0, 2.0, 0.5}));
  ASSERT_EQ(earlier.scans.size(), before.slam.scans.size());
  for (std::size_t i = 0; i < earlier.scans.size(); ++i) {
    ASSERT_EQ(earlier.scans[i].run, before.slam.scans[i].run);
    ASSERT_EQ(earlier.scans[i].map_from_robot, before.slam.scans[i].map_from_robot);
    ASSERT_EQ(earlier.scans[i].scan.ranges_m, before.slam.scans[i].scan.ranges_m);
  }
}

TEST_F(Update, KeepsEarlierPosesAndPlacesTheNewRunInTheirMap) {
  const LearnResult after = go_on();
  EXPECT_TRUE(after.slam.unplaced_runs.empty());
  ASSERT_EQ(after.slam.scans.size(), runs.observations.size());
  for (std::size_t i = 0; i < before.slam.scans.size(); ++i) {
    ASSERT_EQ(after.slam.scans[i].map_from_robot, before.slam.scans[i].map_from_robot) << i;
  }
  const Pose2 map_from_truth = test_room::map_from_truth(runs, before.slam.scans);
  for (std::size_t i = before.slam.scans.size(); i < after.slam.scans.size(); ++i) {
    ASSERT_LT(
        translation_distance(after.slam.scans[i].map_from_robot, map_from_truth * *runs.truths[i]),
        0.1)
        << i;
  }
}

TEST_F(Update, ShowsTheTimescaleMemoryTheNewScansOnly) {
  const LearnResult after = go_on();
  EXPECT_NE(after.timescale->state(), before.timescale->state());
  for (const PosedScan& scan : after.slam.scans) {
    if (scan.run == 2) before.timescale->observe(scan);
  }
  EXPECT_EQ(after.timescale->state(), before.timescale->state());
}

TEST_F(Update, ForgetsPassesOfPlacesThatHaveMore) {
  maps::EarlierRuns earlier = maps::read_earlier_runs(folder.path());
  maps::LearnConfig config;
  config.history.passes_per_place = 1;
  const LearnResult after = learn(of_days(runs, 2, 3), {}, config, {}, kSeed, 2, nullptr, &earlier);
  EXPECT_GT(after.forgotten_scans, 0U);
  EXPECT_EQ(after.slam.scans.size() + after.forgotten_scans, runs.observations.size());
  EXPECT_FALSE(earlier.thinned.empty());
  // What is left has the poses that it had, and the new run is whole.
  std::size_t of_new_run = 0;
  for (const PosedScan& scan : after.slam.scans) of_new_run += scan.run == 2 ? 1 : 0;
  EXPECT_EQ(of_new_run, of_days(runs, 2, 3).size());
  const auto same = [&](const PosedScan& scan) {
    return std::any_of(before.slam.scans.begin(), before.slam.scans.end(),
                       [&](const PosedScan& old) {
                         return old.run == scan.run && old.scan.stamp == scan.scan.stamp &&
                                old.map_from_robot == scan.map_from_robot;
                       });
  };
  for (const PosedScan& scan : after.slam.scans) ASSERT_TRUE(scan.run == 2 || same(scan));
}

TEST_F(Update, RefusesMapsThatKeptNoScans) {
  memory::Store(folder.path() / maps::kStoreFile).save_scans(0, {});
  memory::Store(folder.path() / maps::kStoreFile).save_scans(1, {});
  EXPECT_THROW((void)maps::read_earlier_runs(folder.path()), InputError);
  EXPECT_THROW((void)maps::read_earlier_runs(folder.path() / "elsewhere"), InputError);
}

}  // namespace
}  // namespace strata::pipeline
