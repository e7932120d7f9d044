// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/folded_maps.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tools/laboratory/experiments/hard_buildings.hpp"

namespace strata::experiments {
namespace {

/// 20 m straight ahead and back, a pose every 0.1 m.
std::vector<Pose2> there_and_back() {
  std::vector<Pose2> poses;
  for (int i = 0; i <= 200; ++i) poses.push_back({0.1 * i, 0.0, 0.0});
  for (int i = 199; i >= 0; --i) poses.push_back({0.1 * i, 0.0, 3.0});
  return poses;
}

TEST(Revisits, AreRightWhereverTheMapLies) {
  const std::vector<Pose2> truth = there_and_back();
  std::vector<Pose2> found;
  for (const Pose2& pose : truth) found.push_back(Pose2{3.0, -2.0, 1.0} * pose);
  const Revisits revisits = judge_revisits(found, truth);
  EXPECT_GT(revisits.pairs, 200.0);
  EXPECT_EQ(revisits.wrong, 0.0);
  EXPECT_LT(revisits.worst_m, 1e-9);
  EXPECT_FALSE(revisits.is_folded());
}

// Scans within 5 m of the turn have less than 10 m of way between them, and do not count.
TEST(Revisits, OfAWayBackThatWasPutElsewhereAreWrong) {
  const std::vector<Pose2> truth = there_and_back();
  for (const double off_m : {0.4, 0.6}) {
    std::vector<Pose2> found = truth;
    for (std::size_t i = 201; i < found.size(); ++i) found[i].y += off_m;
    const Revisits revisits = judge_revisits(found, truth);
    EXPECT_EQ(revisits.wrong, off_m > 0.5 ? revisits.pairs : 0.0);
    EXPECT_NEAR(revisits.worst_m, off_m, 1e-9);
    EXPECT_EQ(revisits.is_folded(), off_m > 0.5);
  }
}

TEST(Revisits, ThereAreNoneOnAWayThatGoesOn) {
  const std::vector<Pose2> truth = there_and_back();
  const std::vector<Pose2> ahead(truth.begin(), truth.begin() + 200);
  const Revisits revisits = judge_revisits(ahead, ahead);
  EXPECT_EQ(revisits.pairs, 0.0);
  EXPECT_FALSE(revisits.is_folded());
}

TEST(FoldedMaps, OfALongCorridorIsJudgedByItsPoses) {
  const FoldedMap map = map_building(long_corridor(1), 1);
  EXPECT_GT(map.revisits.pairs, 100.0);
  EXPECT_GT(map.compared, 10.0);
  EXPECT_GT(map.odometry_error_m, 0.5);
  EXPECT_LT(map.error_m, map.odometry_error_m);
}

}  // namespace
}  // namespace strata::experiments
