// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/turning_robot.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace strata::experiments {
namespace {

constexpr std::uint64_t kSeed = 102;  // no figure uses it
const memory::PolarBins kBins;

TEST(TurningRobot, SeesTheBoardFromTheNodeThoughItIsNeverThere) {
  const BoardRoom room = board_room();
  const TwoStates states = board_states(room, kBins, kSeed);
  // 0.7 m at a distance of 1 m: 38.6 degrees about bearing 0.
  EXPECT_NEAR(static_cast<double>(states.bins.size()), 38.6, 2.0);
  for (const std::size_t bin : states.bins) {
    const double bearing = kBins.center_bearing_rad(static_cast<int>(bin));
    EXPECT_NEAR(static_cast<double>(states.after_m[bin]), 1.0 / std::cos(bearing), 0.03) << bin;
    EXPECT_GT(states.before_m[bin], 2.5F) << bin;
  }
  for (const PosedScan& scan : turned_scans(room, true, Looking::kAnywhere, 50, kSeed)) {
    EXPECT_GT((scan.map_from_robot.translation() - room.node_m).norm(), 0.0);
    EXPECT_LE((scan.map_from_robot.translation() - room.node_m).norm(), 0.4);
  }
}

TEST(TurningRobot, NeverSeesAllOfTheNode) {
  const TwoStates states = board_states(board_room(), kBins, kSeed);
  ASSERT_EQ(states.before.size(), 200U);
  for (const memory::VirtualScan& view : states.before) {
    const auto known =
        std::count_if(view.begin(), view.end(), [](float range_m) { return !std::isnan(range_m); });
    EXPECT_LT(known, 260);
    EXPECT_GT(known, 100);
  }
}

TEST(TurningRobot, HidesOneHalfOfTheBoardByTurning) {
  const TurnedAway turned = turn_away(board_room(), kBins, kSeed);
  const auto board = static_cast<double>(turned.states.bins.size());
  EXPECT_NEAR(static_cast<double>(turned.hidden.size()), 0.5 * board, 0.2 * board);
  // The edge of the view is to the left of the robot: what lies further left is hidden.
  for (const std::size_t bin : turned.hidden) EXPECT_LT(bin, 180U);
}

TEST(TurningRobot, CompletesTheHiddenHalfByScenesAndNotBinByBin) {
  PlaceFigures figures;
  figures.seeds = 3;
  const TurnedAway turned = turn_away(board_room(), kBins, kSeed);
  EXPECT_EQ(complete_turned(turned, decoder_named("median of each bin"), figures).complete, 0);
  EXPECT_EQ(complete_turned(turned, decoder_named("scene"), figures).complete, 3);
}

TEST(TurningRobot, WrongPosesShowTheWallsElsewhere) {
  const TwoStates states = wrong_pose_states(board_room(), kBins, kSeed);
  EXPECT_GT(states.bins.size(), 30U);
  PlaceFigures figures;
  figures.seeds = 3;
  EXPECT_EQ(wrong_bins(states, decoder_named("scene"), 0.0, figures), 0.0);
  EXPECT_EQ(wrong_bins(states, decoder_named("scene"), 1.0, figures), 1.0);
}

}  // namespace
}  // namespace strata::experiments
