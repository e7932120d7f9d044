// SPDX-License-Identifier: Apache-2.0
#include "components/maps/earlier_runs.hpp"

#include <vector>

#include <gtest/gtest.h>

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
  const auto runs = new_runs(both(drive(0, 5, 0.0), drive(1, 5, 2.0)), earlier);
  ASSERT_EQ(runs.size(), 1U);
  ASSERT_EQ(runs[0].size(), 5U);
  EXPECT_EQ(runs[0][0].map_from_robot.y, 2.0);
}

TEST(EarlierRuns, AreKnownThoughTheirBeginWasLeftOut) {
  std::vector<PosedScan> late = drive(0, 5, 0.0);
  late.erase(late.begin(), late.begin() + 3);
  EXPECT_TRUE(new_runs(drive(7, 5, 0.0), learned(late, 1)).empty());
  // Drives may share where they begin.
  std::vector<PosedScan> other = drive(0, 5, 1.0);
  other[0] = drive(0, 1, 0.0)[0];
  EXPECT_EQ(new_runs(other, learned(drive(0, 5, 0.0), 1)).size(), 1U);
  EXPECT_TRUE(new_runs(drive(3, 1, 0.0), learned(drive(0, 5, 0.0), 1)).empty());
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
