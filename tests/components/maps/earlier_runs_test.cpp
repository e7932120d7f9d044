// SPDX-License-Identifier: Apache-2.0
#include "components/maps/earlier_runs.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/maps/maps_folder.hpp"
#include "core/base/damage.hpp"
#include "tests/support/test_data.hpp"

namespace strata::maps {
namespace {

/// Whose stamps begin at 0, as of many loggers.
std::vector<PosedScan> drive(int run, std::size_t scans, double y_m) {
  std::vector<PosedScan> all(scans);
  for (std::size_t i = 0; i < scans; ++i) {
    all[i].run = run;
    all[i].scan.stamp = Stamp::from_seconds(static_cast<double>(i));
    all[i].map_from_robot = {0.1 * static_cast<double>(i), y_m, 0.0};
  }
  return all;
}

std::vector<PosedScan> both(std::vector<PosedScan> one, const std::vector<PosedScan>& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

EarlierRuns learned(std::vector<PosedScan> scans, int next_run) {
  EarlierRuns earlier;
  earlier.scans = std::move(scans);
  earlier.next_run = next_run;
  return earlier;
}

TEST(EarlierRuns, AreToldFromNewOnesOfTheSameStamps) {
  const EarlierRuns earlier = learned(drive(0, 5, 0.0), 1);
  const auto runs = new_runs(learned(both(drive(0, 5, 0.0), drive(1, 5, 2.0)), 2), earlier);
  ASSERT_EQ(runs.size(), 1U);
  ASSERT_EQ(runs[0].size(), 5U);
  EXPECT_EQ(runs[0][0].map_from_robot.y, 2.0);
}

TEST(EarlierRuns, AreKnownThoughTheirBeginWasLeftOut) {
  std::vector<PosedScan> late = drive(0, 5, 0.0);
  late.erase(late.begin(), late.begin() + 3);
  EXPECT_TRUE(new_runs(learned(drive(7, 5, 0.0), 8), learned(late, 1)).empty());
  // Drives may share where they begin.
  std::vector<PosedScan> other = drive(0, 5, 1.0);
  other[0] = drive(0, 1, 0.0)[0];
  EXPECT_EQ(new_runs(learned(other, 1), learned(drive(0, 5, 0.0), 1)).size(), 1U);
  EXPECT_TRUE(new_runs(learned(drive(3, 1, 0.0), 4), learned(drive(0, 5, 0.0), 1)).empty());
}

/// One drive a night past the same places.
EarlierRuns of_nights(int count) {
  std::vector<PosedScan> scans;
  for (int night = 0; night < count; ++night) {
    for (PosedScan& scan : drive(night, 5, 0.01 * night)) {
      scan.scan.stamp.ns += 86'400'000'000'000 * night;
      scans.push_back(scan);
    }
  }
  return learned(scans, count);
}

TEST(EarlierRuns, ThatAreForgottenAreNotNew) {
  const EarlierRuns all = of_nights(6);
  EarlierRuns earlier = of_nights(6);
  EXPECT_EQ(forget_scans(earlier, {.passes_per_place = 6}), 0U);
  EXPECT_TRUE(earlier.thinned.empty());
  EXPECT_EQ(forget_scans(earlier, {.passes_per_place = 2}), 20U);
  EXPECT_EQ(earlier.scans.size(), 10U);
  ASSERT_EQ(earlier.thinned.size(), 4U);
  for (const ThinnedRun& run : earlier.thinned) {
    EXPECT_EQ(run.begin_ns, 86'400'000'000'000 * run.run);
    EXPECT_EQ(std::count_if(earlier.scans.begin(), earlier.scans.end(),
                            [&](const PosedScan& scan) { return scan.run == run.run; }),
              0);
  }
  EXPECT_TRUE(new_runs(all, earlier).empty());
  // Where it was forgotten in another way it is the same run still.
  EarlierRuns other = of_nights(7);
  EXPECT_EQ(new_runs(other, earlier).size(), 1U);
  (void)forget_scans(other, {.passes_per_place = 3});
  EXPECT_EQ(new_runs(other, earlier).size(), thinned_run(other.thinned, 6) == nullptr ? 1U : 0U);
}

TEST(EarlierRuns, KeepTheNameThatTheyHadWhenTheyWereWhole) {
  EarlierRuns earlier = of_nights(4);
  // A place of its own for each pair of nights, besides the one that all pass.
  for (PosedScan& scan : earlier.scans) {
    if (scan.scan.stamp.ns % 86'400'000'000'000 < 3'000'000'000) continue;
    scan.map_from_robot.x += scan.run < 2 ? 4.0 : 8.0;
  }
  const EarlierRuns whole = earlier;
  (void)forget_scans(earlier, {.passes_per_place = 3});
  ASSERT_EQ(earlier.thinned.size(), 1U);
  const ThinnedRun before = earlier.thinned[0];
  const auto scans_left = [&] {
    return std::count_if(earlier.scans.begin(), earlier.scans.end(),
                         [&](const PosedScan& scan) { return scan.run == before.run; });
  };
  ASSERT_GT(scans_left(), 0);
  (void)forget_scans(earlier, {.passes_per_place = 1});
  ASSERT_EQ(scans_left(), 0) << "it has lost scans twice";
  ASSERT_EQ(earlier.thinned.size(), 3U) << "and is named once";
  EXPECT_EQ(earlier.thinned[0].visit, before.visit);
  EXPECT_TRUE(new_runs(whole, earlier).empty());
}

TEST(EarlierRuns, GiveNoIdAwayThatAForgottenRunHad) {
  const test::TemporaryDirectory folder;
  memory::Store(folder.path() / kStoreFile).save_scans(3, drive(3, 5, 0.0));
  EXPECT_EQ(read_earlier_runs(folder.path()).next_run, 4);
  write_thinned_runs(folder.path(), std::vector<ThinnedRun>{{1, "a", 0}, {7, "b", 0}});
  EXPECT_EQ(read_earlier_runs(folder.path()).next_run, 8);
}

TEST(EarlierRuns, AreNamedInTheFolder) {
  const test::TemporaryDirectory folder;
  const std::vector<ThinnedRun> thinned = {{3, "abc", -5}, {7, "def", 1LL << 60}};
  write_thinned_runs(folder.path(), {});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / kStoreFile));
  write_thinned_runs(folder.path(), thinned);
  memory::Store store(folder.path() / kStoreFile);
  const std::vector<ThinnedRun> read = read_thinned_runs(store);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].run, 7);
  EXPECT_EQ(read[1].visit, "def");
  EXPECT_EQ(read[1].begin_ns, 1LL << 60);
  EXPECT_EQ(read[0].begin_ns, -5);
  for (const char* damaged : {"[[3,4,5]]", "[[", "[[1]]"}) {
    store.save_text("thinned_runs", damaged);
    EXPECT_THROW((void)read_thinned_runs(store), DamageError) << damaged;
  }
}

TEST(EarlierRuns, GetMoreThatAreNewToWhoGoesOn) {
  EarlierRuns earlier = learned(drive(0, 2, 0.0), 4);
  add_run(earlier, drive(0, 3, 1.0));
  add_run(earlier, drive(0, 1, 2.0));
  ASSERT_EQ(earlier.scans.size(), 6U);
  EXPECT_EQ(earlier.scans[1].run, 0);
  EXPECT_EQ(earlier.scans[2].run, 4);
  EXPECT_EQ(earlier.scans[4].run, 4);
  EXPECT_EQ(earlier.scans[5].run, 5);
  EXPECT_EQ(earlier.next_run, 4);
}

}  // namespace
}  // namespace strata::maps
