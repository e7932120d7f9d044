// SPDX-License-Identifier: Apache-2.0
#include "core/cells/cell_learner.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/core/cells/corridor.hpp"

namespace strata::cells {
namespace {

using namespace test_corridor;

/// A door that is drawn anew at a rate, visited at random times.
CellLearner visited_door(double closed, double rate_per_s, double mean_gap_s, int visits,
                         std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  CellLearner learner(kResolution_m);
  bool is_closed = random.bernoulli(closed);
  double time_s = 0.0;
  for (int i = 0; i < visits; ++i) {
    const double dt_s = 15.0 + random.exponential(1.0 / mean_gap_s);
    time_s += dt_s;
    if (!random.bernoulli(std::exp(-rate_per_s * dt_s))) is_closed = random.bernoulli(closed);
    visit(learner, time_s, is_closed);
  }
  return learner;
}

TEST(CellLearner, LearnsTheShareAndTheRateOfADoor) {
  for (const double closed : {0.3, 0.8}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      CellLearner learner = visited_door(closed, 1.0 / 900.0, 900.0, 4000, seed);
      const CellMap map = learned(learner);
      const CellState& door = state_at(map, kDoor);
      EXPECT_NEAR(static_cast<double>(door.usual) / closed, 1.0, 0.15) << closed << " " << seed;
      EXPECT_NEAR(static_cast<double>(door.rate_per_s) * 900.0, 1.0, 0.2) << closed << " " << seed;
    }
  }
}

TEST(CellLearner, HoldsAWallForAWallAndTheWayForFree) {
  CellLearner learner(kResolution_m);
  for (int i = 0; i < 20; ++i) visit(learner, 3600.0 * i, false);
  const CellMap map = learned(learner);
  EXPECT_GT(state_at(map, kWall).usual, 0.99F);
  EXPECT_LT(state_at(map, kFree).usual, 0.01F);
  EXPECT_TRUE(state_at(map, kWall).is_occupied());
  EXPECT_FALSE(state_at(map, kFree).is_occupied());
  EXPECT_FALSE(state_at(map, {1.02, 1.02}).is_known);
  EXPECT_EQ(map.changed, 0U);
}

/// By hand: n visits an hour apart, none of which changed anything, of a cell that fades at the
/// prior's rate of 1/h are 1 + (n - 1) (1 - 1/e) draws.
TEST(CellLearner, OfACellThatNeverChangedIsTheClosedForm) {
  CellLearner learner(kResolution_m);
  for (int i = 0; i < 10; ++i) visit(learner, 3600.0 * i, false);
  const CellMap map = learned(learner);
  const double draws = 1.0 + 9.0 * (1.0 - std::exp(-1.0));
  const double usual = 0.01 / (draws + 0.02);  // the least of prior sightings, as nothing changed
  EXPECT_NEAR(static_cast<double>(state_at(map, kFree).usual), usual, 1e-6);
  EXPECT_NEAR(static_cast<double>(state_at(map, kWall).usual), 1.0 - usual, 1e-6);
  EXPECT_NEAR(static_cast<double>(state_at(map, kWall).rate_per_s), 1.0 / 3600.0, 1e-9);
}

// The closed form stands in for the chain of these looks.
TEST(CellLearner, OfACellThatNeverChangedIsCloseToTheChainOfItsLooks) {
  CellLearner learner(kResolution_m);
  for (int i = 0; i < 10; ++i) visit(learner, 3600.0 * i, false);
  const CellMap map = learned(learner);
  patch::SequenceHistory history;
  std::vector<std::vector<double>> looks;
  for (int i = 0; i < 10; ++i) {
    history.append(3600.0);
    looks.push_back({0.999, 0.001});
  }
  patch::ChainConfig config;
  config.prior_sightings = map.sightings;
  const patch::Chain chain = patch::learn_chain(looks, history, config);
  EXPECT_NEAR(chain.usual[1], static_cast<double>(state_at(map, kFree).usual), 0.01);
  EXPECT_NEAR(chain.rate_per_s * 3600.0, 1.0, 0.5);
}

TEST(CellLearner, PoolsTheShareOfLooksThatDiffer) {
  // Of 1 way cell's, ... only the door changes, in each of 39 visits.
  CellLearner learner(kResolution_m);
  for (int i = 0; i < 40; ++i) visit(learner, 3600.0 * i, i % 2 == 1);
  const CellMap map = learned(learner);
  // 50 cells on the way to the door and the door are seen 40 times, what lies behind it 20 times.
  EXPECT_EQ(map.changed, 1U);
  EXPECT_EQ(map.known, 101U);
  const double transitions = 51.0 * 39.0 + 50.0 * 19.0;
  const double differ = 39.0 / transitions;
  EXPECT_NEAR(map.sightings, differ / (1.0 - 2.0 * differ), 1e-9);
}

TEST(CellLearner, SeesADoorMoveBeforeARobotThatStands) {
  CellLearner learner(kResolution_m);
  for (int i = 0; i < 6000; ++i) learner.add(look(0.2 * i, (i / 1500) % 2 == 1));
  const CellMap map = learned(learner);
  EXPECT_NEAR(static_cast<double>(state_at(map, kDoor).usual), 0.5, 0.2);
  // Three changes in 20 minutes; two looks of three differ after long times.
  const double changes_per_h = 3600.0 * static_cast<double>(state_at(map, kDoor).rate_per_s) * 0.5;
  EXPECT_GT(changes_per_h, 2.0);
  EXPECT_LT(changes_per_h, 20.0);
}

TEST(CellLearner, OneBeamThatHitsSomebodyDoesNotChangeACell) {
  CellLearner learner(kResolution_m);
  for (int i = 0; i < 20; ++i) {
    visit(learner, 3600.0 * i, false);
    learner.add(look(3600.0 * i + 0.4, i == 10));
    visit(learner, 3600.0 * i + 0.5, false);
  }
  EXPECT_LT(state_at(learned(learner), kDoor).usual, 0.02F);
}

// One hit and one beam that passes say 2.48 - 0.87 nats; half a miss more would be too little.
TEST(CellLearner, TheCellWhereABeamEndsGetsNoMissFromIt) {
  CellConfig config;
  config.min_look_nats = 1.4;
  CellLearner learner(kResolution_m, config);
  learner.add(look(0.0, true));
  learner.add(look(0.1, false));
  EXPECT_TRUE(state_at(learned(learner), kDoor).is_known);
}

TEST(CellLearner, StampsOfTwoRunsMayOverlap) {
  CellLearner one(kResolution_m);
  for (int i = 0; i < 10; ++i) visit(one, 3600.0 * i, true, 0);
  for (int i = 0; i < 10; ++i) visit(one, 3600.0 * i, true, 1);
  const CellMap map = learned(one);
  EXPECT_GT(state_at(map, kDoor).usual, 0.99F);
  EXPECT_EQ(map.changed, 0U);
}

TEST(CellLearner, ScansThatSayNothingTeachNothing) {
  CellLearner learner(kResolution_m);
  PosedScan empty = look(0.0, true);
  empty.scan.ranges_m = {std::numeric_limits<float>::quiet_NaN(),
                         std::numeric_limits<float>::infinity(), -1.0F};
  empty.scan.free_range_m = 3.0F;  // scans that are kept do not tell
  learner.add(empty);
  empty.scan.ranges_m.clear();
  learner.add(empty);
  EXPECT_EQ(learned(learner).known, 0U);
}

TEST(CellLearner, IsTheSameWithAnyNumberOfThreads) {
  CellLearner one = visited_door(0.3, 1.0 / 900.0, 900.0, 300, 4);
  CellLearner four = visited_door(0.3, 1.0 / 900.0, 900.0, 300, 4);
  const CellMap a = learned(one, 1);
  const CellMap b = learned(four, 4);
  ASSERT_EQ(a.known, b.known);
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    const CellState& of_a = a.cells.get(a.cells.cell(i));
    const CellState& of_b = b.cells.get(b.cells.cell(i));
    ASSERT_EQ(std::bit_cast<std::uint32_t>(of_a.usual), std::bit_cast<std::uint32_t>(of_b.usual));
    ASSERT_EQ(std::bit_cast<std::uint32_t>(of_a.rate_per_s),
              std::bit_cast<std::uint32_t>(of_b.rate_per_s));
  }
}

}  // namespace
}  // namespace strata::cells
