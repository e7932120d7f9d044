// SPDX-License-Identifier: Apache-2.0
#include "core/slam/consistency.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/parallel.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::slam {
namespace {

using strata::test::Wall;

/// A corridor of 40 m with niches, so that its walls differ along it.
std::vector<Wall> corridor(bool with_door_closed) {
  std::vector<Wall> walls = {{0, 0, 40, 0}, {0, 0, 0, 2.4}, {40, 0, 40, 2.4}};
  for (int i = 0; i < 8; ++i) {
    const double x = 5.0 * i;
    walls.push_back({x, 2.4, x + 3.4, 2.4});
    if (i == 3 && with_door_closed) {
      walls.push_back({x + 3.4, 2.4, x + 5.0, 2.4});
      continue;
    }
    walls.push_back({x + 3.4, 2.4, x + 3.4, 4.4});
    walls.push_back({x + 3.4, 4.4, x + 5.0, 4.4});
    walls.push_back({x + 5.0, 4.4, x + 5.0, 2.4});
  }
  return walls;
}

/// There, and back, where poses are off by `off` and walls may have changed.
std::vector<PosedScan> there_and_back(const Pose2& off, bool door_closes = false) {
  std::vector<PosedScan> scans;
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<Wall> walls = corridor(pass == 1 && door_closes);
    for (int i = 0; i < 180; ++i) {
      const double x = pass == 0 ? 2.0 + 0.2 * i : 38.0 - 0.2 * i;
      const Pose2 pose{x, 1.2, pass == 0 ? 0.0 : std::numbers::pi};
      PosedScan posed;
      posed.scan = strata::test::scan_of(walls, pose, 1.0 * (180 * pass + i), 0.01);
      posed.map_from_robot = pass == 0 ? pose : off * pose;
      scans.push_back(posed);
    }
  }
  return scans;
}

Consistency checked(const std::vector<PosedScan>& scans, int threads = 1) {
  WorkerPool pool(threads);
  return check_consistency(scans, pool);
}

TEST(Consistency, HoldsOfTwoPassesThatFit) {
  const Consistency found = checked(there_and_back({}));
  EXPECT_TRUE(found.consistent);
  EXPECT_GT(found.compared, 10U);
  EXPECT_EQ(found.contradicting, 0U);
  EXPECT_TRUE(found.places.empty());
}

TEST(Consistency, HoldsWhereADoorWasClosed) {
  const Consistency found = checked(there_and_back({}, true));
  EXPECT_TRUE(found.consistent);
  EXPECT_EQ(found.contradicting, 0U);
}

TEST(Consistency, DoesNotHoldOfAMapThatIsBent) {
  for (const Pose2& off : {Pose2{0.0, 1.0, 0.0}, Pose2{0.0, -0.8, 0.0}, Pose2{0.0, 0.0, 0.06}}) {
    const Consistency found = checked(there_and_back(off));
    EXPECT_FALSE(found.consistent) << off.y << " " << off.theta;
    ASSERT_FALSE(found.places.empty());
    EXPECT_GT(found.places.front().share, 0.4);
    EXPECT_GE(found.contradicting, found.places.size());
  }
}

TEST(Consistency, CountsTheCellsInWhichWaysAgreeAndContradict) {
  const Consistency good = checked(there_and_back({}));
  const Consistency bent = checked(there_and_back(Pose2{0.0, 1.0, 0.0}));
  EXPECT_GT(good.fitting_cells, 20 * good.contradicting_cells);
  EXPECT_GT(bent.contradicting_cells, bent.fitting_cells / 2);
  EXPECT_LT(bent.agreement_cells(), 0.5 * good.agreement_cells());
  std::size_t cells = 0;
  WorkerPool pool(1);
  for (const ComparedStretches& pair : compare_stretches(there_and_back({}), pool)) {
    cells += pair.cells;
  }
  EXPECT_EQ(good.fitting_cells + good.contradicting_cells, cells);
}

TEST(Consistency, DoesNotHoldWhereOneOfManyRunsContradictsTheOthers) {
  std::vector<PosedScan> scans;
  const auto add_run = [&](int run, const Pose2& off) {
    std::vector<PosedScan> pass = there_and_back({});
    pass.resize(180);
    for (PosedScan& scan : pass) {
      scan.run = run;
      scan.map_from_robot = off * scan.map_from_robot;
      scans.push_back(std::move(scan));
    }
  };
  for (int run = 0; run < 30; ++run) add_run(run, {});
  EXPECT_TRUE(checked(scans, 2).against_others.empty());
  add_run(30, {0.0, 0.0, 0.012});
  for (int run = 31; run < 40; ++run) add_run(run, {});
  const Consistency found = checked(scans, 2);
  EXPECT_EQ(found.against_others, std::vector<int>{30});
  EXPECT_FALSE(found.consistent);
  // Of all pairs these are too few to be seen.
  EXPECT_LT(static_cast<double>(found.contradicting), 0.01 * static_cast<double>(found.compared));
}

TEST(Consistency, NamesThePlaceAndBothMoments) {
  // The way back is right but for its last third.
  std::vector<PosedScan> scans = there_and_back({});
  for (std::size_t i = 300; i < scans.size(); ++i) scans[i].map_from_robot.y += 1.0;
  const Consistency found = checked(scans);
  ASSERT_FALSE(found.places.empty());
  for (const ComparedStretches& place : found.places) {
    EXPECT_LT(place.x_m, 25.0);
    EXPECT_GE(std::max(place.first.seconds(), place.second.seconds()), 280.0);
  }
}

TEST(Consistency, OfNothingAndOfOnePassHolds) {
  EXPECT_TRUE(checked({}).consistent);
  std::vector<PosedScan> scans = there_and_back({});
  scans.resize(180);
  EXPECT_TRUE(checked(scans).consistent);
}

TEST(Consistency, HasTheSameBitsAtAnyNumberOfThreads) {
  const std::vector<PosedScan> scans = there_and_back({0.0, 0.0, 0.06});
  const Consistency one = checked(scans, 1);
  for (const int threads : {2, 8}) {
    const Consistency many = checked(scans, threads);
    ASSERT_EQ(many.places.size(), one.places.size());
    EXPECT_EQ(many.contradicting, one.contradicting);
    for (std::size_t i = 0; i < one.places.size(); ++i) {
      EXPECT_EQ(many.places[i].share, one.places[i].share);
      EXPECT_EQ(many.places[i].x_m, one.places[i].x_m);
    }
  }
}

}  // namespace
}  // namespace strata::slam
