// SPDX-License-Identifier: Apache-2.0
#include "core/scan/drop_outs.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/scan/drop_out_tally.hpp"
#include "core/scan/scans_around.hpp"
#include "tests/core/scan/corridor_drive.hpp"

namespace strata {
namespace {

using namespace test;

DropOuts find(std::vector<PosedScan>& scans, const NoReturnConfig& config = {}, int threads = 1) {
  WorkerPool pool(threads);
  return find_drop_outs(scans, config, pool);
}

TEST(DropOuts, BeamsWithoutReturnSayNothingWhereReturnsDropOutByThemselves) {
  Drive d = drive(room, always(0.02));
  const DropOuts found = find(d.scans);
  EXPECT_GT(found.no_returns, 100U);
  EXPECT_GT(found.dropped, found.no_returns / 2) << "in a room every beam meets something";
  EXPECT_EQ(found.free_range_m, 0.0);
  for (const PosedScan& scan : d.scans) {
    EXPECT_EQ(scan.scan.free_range_m, 0.0F);
    EXPECT_TRUE(scan.scan.drop_outs.empty());
  }
}

TEST(DropOuts, BeamsAlongACorridorSayThatNothingIsThereAndThoseThatDroppedOutAreTold) {
  Drive d = drive(corridor, always(0.01));
  const DropOuts found = find(d.scans);
  EXPECT_NEAR(found.free_range_m, 0.95 * kReach_m, 1e-9);
  EXPECT_NEAR(static_cast<double>(found.dropped),
              0.01 * static_cast<double>(found.dropped + found.returned),
              0.003 * static_cast<double>(found.dropped + found.returned));
  std::size_t lost = 0;
  std::size_t told = 0;
  std::size_t wrong = 0;
  for (std::size_t i = 1; i + 1 < d.scans.size(); ++i) {
    const Scan& scan = d.scans[i].scan;
    EXPECT_EQ(scan.free_range_m, static_cast<float>(found.free_range_m));
    for (const std::uint32_t beam : scan.drop_outs) {
      ASSERT_EQ(scan.kind(beam), BeamKind::kNoReturn);
      ++(d.lost[i][beam] ? told : wrong);
    }
    for (const bool one : d.lost[i]) lost += one ? 1U : 0U;
  }
  EXPECT_GT(lost, 100U);
  EXPECT_GT(static_cast<double>(told), 0.85 * static_cast<double>(lost));
  EXPECT_LT(static_cast<double>(wrong), 0.02 * static_cast<double>(told));
}

TEST(DropOuts, NothingIsSaidHoweverManyReturnsDropOut) {
  for (const double drop : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.0}) {
    Drive d = drive(corridor, always(drop));
    EXPECT_EQ(find(d.scans).free_range_m, 0.0) << drop;
  }
}

TEST(DropOuts, OfADoorThatOpensNoneIsTold) {
  Drive d = drive(gate_that_opens(10.0), always(0.0));
  const DropOuts found = find(d.scans);
  EXPECT_GT(found.no_returns, 1000U);
  EXPECT_EQ(found.dropped, 0U);
  EXPECT_GT(found.free_range_m, 0.0);
}

TEST(DropOuts, ScansOfAnotherRunOrOfLongBeforeOrOfElsewhereAreNotAsked) {
  // The gate is open for a second only: between two runs, or while nobody looks.
  const World world = [](double x_m, double y_m, double angle_rad, double time_s) {
    return gate_that_opens(time_s < 7.0 ? 6.0 : 1e9)(x_m, y_m, angle_rad, time_s);
  };
  struct Case {
    int run_step;
    double gap_s;
    double jump_m;
  };
  for (const auto& [run_step, gap_s, jump_m] :
       {Case{0, 0.0, 0.0}, Case{1, 0.0, 0.0}, Case{0, 60.0, 0.0}, Case{0, 0.0, 3.0}}) {
    Drive d = drive(world, always(0.0));
    for (std::size_t i = 0; i < d.scans.size(); ++i) {
      const auto part = static_cast<int>(i >= 30) + static_cast<int>(i >= 35);
      d.scans[i].run = part * run_step;
      d.scans[i].map_from_robot.x += part == 1 ? jump_m : 0.0;
      d.scans[i].scan.stamp.ns += static_cast<std::int64_t>(part * gap_s * 1e9);
    }
    const bool is_asked = run_step == 0 && gap_s == 0.0 && jump_m == 0.0;
    EXPECT_EQ(find(d.scans).dropped > 0, is_asked) << run_step << ' ' << gap_s << ' ' << jump_m;
  }
}

TEST(DropOuts, OfADoorThatOpensBeamsAreBelievedOnceNoScanAroundShowsIt) {
  Drive d = drive(gate_that_opens(6.0), always(0.0));
  (void)find(d.scans);
  EXPECT_GT(silent_between(d, 6.0, 6.5), 20U);
  EXPECT_EQ(silent_between(d, 9.05, 9.5), 0U);
}

TEST(DropOuts, BeamsThatAreFewInARowSayNothing) {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  Scan scan;
  scan.range_max_m = 8.0F;
  scan.ranges_m = {1.0F, kNone, 1.0F, kNone, kNone, 1.0F, kNone, kNone, kNone, 1.0F, kNone};
  std::vector<std::uint32_t> silent;
  const auto add = [&](std::uint32_t beam) { silent.push_back(beam); };
  for_each_silent(scan, {}, {}, 8.0, add);
  EXPECT_EQ(silent, (std::vector<std::uint32_t>{1, 3, 4, 10}));
  scan.ranges_m.assign(3, kNone);
  silent.clear();
  for_each_silent(scan, {}, {}, 8.0, add);
  EXPECT_TRUE(silent.empty());
  scan.ranges_m.clear();
  for_each_silent(scan, {}, {}, 8.0, add);
  EXPECT_TRUE(silent.empty());
}

TEST(DropOuts, BeamsOfScansWithoutOthersBeforeAndAfterSayNothing) {
  Drive d = drive(corridor, always(0.01));
  for (std::size_t i = 0; i < d.scans.size(); ++i) {
    const auto gaps = static_cast<std::int64_t>(i >= 50) + static_cast<std::int64_t>(i >= 51);
    d.scans[i].scan.stamp.ns += gaps * 60'000'000'000;
  }
  EXPECT_GT(find(d.scans).free_range_m, 0.0);
  for (std::size_t i = 0; i < d.scans.size(); ++i) {
    const bool is_judged = i > 0 && (i < 49 || i > 51) && i + 1 < d.scans.size();
    EXPECT_EQ(d.scans[i].scan.free_range_m > 0.0F, is_judged) << i;
    EXPECT_TRUE(is_judged || d.scans[i].scan.drop_outs.empty());
  }
}

TEST(DropOuts, BeamsAreBelievedAsFarAsSurfacesReturn) {
  // Half of what lies beyond 5 m is too dark.
  Drive d = drive(corridor, [](double range_m) { return range_m > 5.0 ? 0.5 : 0.001; });
  const DropOuts found = find(d.scans, {.max_drop_out_share = 1.0});
  EXPECT_GT(found.free_range_m, 4.0);
  EXPECT_LE(found.free_range_m, 5.0);
}

TEST(DropOuts, NothingIsSaidWhereABuildingEndsLongBeforeTheReach) {
  // A black door that returns nothing at all, in a room that a scanner of 30 m sees whole.
  const World world = [](double x_m, double y_m, double angle_rad, double time_s) {
    const double range = room(x_m, y_m, angle_rad, time_s);
    const bool is_black = std::abs(y_m + range * std::sin(angle_rad)) < 0.5;
    return std::cos(angle_rad) > 0.0 && is_black ? std::numeric_limits<double>::infinity() : range;
  };
  for (const float range_max_m : {30.0F, 5.0F}) {
    Drive d = drive(world, always(0.0));
    for (PosedScan& scan : d.scans) scan.scan.range_max_m = range_max_m;
    const DropOuts found = find(d.scans);
    EXPECT_GT(found.no_returns, 1000U);
    EXPECT_LT(found.dropped, found.no_returns / 20) << "nothing but this tells";
    EXPECT_EQ(found.free_range_m > 0.0, range_max_m < 10.0F) << range_max_m;
  }
}

TEST(DropOuts, AFewCloseByDoNotJudgeWhatLiesFurtherAway) {
  DropOutTally tally;
  for (int i = 0; i < 5000; ++i) {
    tally.add_no_return();
    if (i % 3 == 0) tally.add_far();
    if (i < 40) tally.add_surface(0.05, i % 4 == 0);  // legs that move
    if (i >= 40) tally.add_surface(0.3 + 0.0001 * i, i % 400 == 0);
  }
  EXPECT_NEAR(tally.free_range_m(8.0, {}), 0.95 * 8.0, 1e-9);
  for (int i = 0; i < 5000; ++i) tally.add_surface(0.05, i % 4 == 0);
  EXPECT_EQ(tally.free_range_m(8.0, {.max_drop_out_share = 1.0}), 0.0);
}

TEST(DropOuts, NothingIsSaidOfAScannerWhoseReachIsNotTold) {
  for (const float range_max_m : {0.0F, kInf, std::numeric_limits<float>::quiet_NaN()}) {
    Drive d = drive(corridor, always(0.01));
    for (PosedScan& scan : d.scans) scan.scan.range_max_m = range_max_m;
    EXPECT_EQ(find(d.scans).free_range_m, 0.0) << range_max_m;
  }
}

TEST(DropOuts, OneScannerIsNotJudgedByAnother) {
  Drive good = drive(corridor, always(0.005));
  Drive bad = drive(corridor, always(0.4));
  std::vector<PosedScan> both;
  for (std::size_t i = 0; i < good.scans.size(); ++i) {
    both.push_back(good.scans[i]);
    bad.scans[i].scan.robot_from_laser = {-0.2, 0.0, 0.0};
    bad.scans[i].map_from_robot = bad.scans[i].map_from_robot * Pose2{0.2, 0.0, 0.0};
    both.push_back(bad.scans[i]);
  }
  (void)find(both);
  for (std::size_t i = 2; i + 2 < both.size(); ++i) {  // the first and the last are not judged
    EXPECT_EQ(both[i].scan.free_range_m > 0.0F, i % 2 == 0) << i;
  }
}

TEST(DropOuts, AScannerThatSendsOtherAnglesWithEachScanIsOne) {
  Drive d = drive(corridor, always(0.005));
  const double plain = find(d.scans).free_range_m;
  for (std::size_t i = 0; i < d.scans.size(); ++i) {
    Scan& scan = d.scans[i].scan;
    // Up to two beams fewer at one end.
    scan.angle_min_rad += static_cast<float>(i % 3) * scan.angle_increment_rad;
    scan.ranges_m.erase(scan.ranges_m.begin(),
                        scan.ranges_m.begin() + static_cast<std::ptrdiff_t>(i % 3));
  }
  EXPECT_EQ(find(d.scans).free_range_m, plain);
  EXPECT_GT(plain, 0.0);
}

TEST(DropOuts, AreTheSameForAnyNumberOfThreads) {
  Drive one = drive(corridor, always(0.01), 60.0);
  const DropOuts found = find(one.scans);
  for (const int threads : {2, 8}) {
    Drive other = drive(corridor, always(0.01), 60.0);
    EXPECT_EQ(find(other.scans, {}, threads), found);
    for (std::size_t i = 0; i < one.scans.size(); ++i) {
      ASSERT_EQ(other.scans[i].scan.drop_outs, one.scans[i].scan.drop_outs);
    }
  }
}

TEST(DropOuts, WhatWasFoundBeforeIsForgotten) {
  Drive d = drive(corridor, always(0.01));
  const DropOuts found = find(d.scans);
  EXPECT_EQ(find(d.scans), found);
  EXPECT_EQ(find(d.scans, {.is_used = false}), DropOuts{});
  EXPECT_EQ(d.scans[5].scan.free_range_m, 0.0F);
  EXPECT_TRUE(d.scans[5].scan.drop_outs.empty());
}

TEST(DropOuts, AFewBeamsWithoutReturnJudgeNoScanner) {
  Drive d = drive(corridor, always(0.0), 2.0);
  const Drive longer = drive(corridor, always(0.0), 4.0);
  for (PosedScan& scan : d.scans) {
    std::size_t left = 10;  // of a scan's beams without return
    for (float& range : scan.scan.ranges_m) {
      if (range == kInf && (left == 0 || left-- == 0)) range = std::nanf("");
    }
  }
  const DropOuts few = find(d.scans);
  EXPECT_GT(few.returned, 200U);
  EXPECT_LT(few.no_returns, 100U);
  EXPECT_EQ(few.free_range_m, 0.0);
  std::vector<PosedScan> all = longer.scans;
  EXPECT_GT(find(all).free_range_m, 0.0);
}

TEST(DropOuts, OfScansThatSayNothingAreNone) {
  std::vector<PosedScan> none;
  EXPECT_EQ(find(none), DropOuts{});
  Drive d = drive(corridor, always(0.0), 2.0);
  d.scans.resize(4);
  d.scans[1].scan.ranges_m.clear();
  d.scans[2].scan.ranges_m.assign(180, std::numeric_limits<float>::quiet_NaN());
  d.scans[3].scan.ranges_m.resize(90);
  EXPECT_EQ(find(d.scans).free_range_m, 0.0) << "too few to judge by";
  // Angles that do not grow, and poses that are no numbers.
  Drive odd = drive(corridor, always(0.0), 4.0);
  odd.scans[3].scan.angle_increment_rad = 0.0F;
  odd.scans[9].scan.angle_increment_rad = std::nanf("");
  odd.scans[12].map_from_robot.x = std::nan("");
  EXPECT_GT(find(odd.scans).free_range_m, 0.0);
}

}  // namespace
}  // namespace strata
