// SPDX-License-Identifier: Apache-2.0
/// Levels that learn by days: daily, weekly.
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

constexpr double kDay_s = 86400.0;

TimescaleConfig with_daily_and_weekly() {
  TimescaleConfig config;
  config.levels = {{"short", 5, 3.1}, {"daily", 50, 27.0, 3.0}, {"weekly", 50, 27.0, 21.0}};
  return config;
}

/// A robot that stands at the origin for `scans` seconds from noon on.
void spend_day(TimescaleMemory& memory, int day, int scans, bool with_box, int run = 0) {
  for (int i = 0; i < scans; ++i) {
    PosedScan scan = observe({0.0, 0.0, 0.0}, (day + 0.5) * kDay_s + i, with_box);
    scan.run = run;
    memory.observe(scan);
  }
}

/// Share of the samples that show the box, in the bins that it covers.
double share_of_box(const TimescaleMemory& memory, std::size_t level) {
  double with = 0.0;
  double all = 0.0;
  for (int a = 0; a < 20; ++a) {
    for (const float range_m : memory.nodes()[0].levels[level].samples(a)) {
      with += range_m < 3.0F ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  return with / all;
}

TEST(DayLevels, ForgetHalfInTheirHalfLifeHoweverLongTheRobotStays) {
  for (const int scans_a_day : {60, 600}) {
    TimescaleMemory memory(with_daily_and_weekly());
    spend_day(memory, 0, scans_a_day, true);
    for (int day = 1; day <= 21; ++day) {
      spend_day(memory, day, scans_a_day, false);
      memory.close_day();
      // 1,000 samples in these bins: a standard deviation of at most 0.016.
      EXPECT_NEAR(share_of_box(memory, 1), std::exp2(-day / 3.0), 0.06) << day;
      EXPECT_NEAR(share_of_box(memory, 2), std::exp2(-day / 21.0), 0.06) << day;
    }
  }
}

TEST(DayLevels, ChangeAtTheEndOfADayOnly) {
  TimescaleMemory memory(with_daily_and_weekly());
  spend_day(memory, 0, 100, true);
  EXPECT_EQ(memory.nodes()[0].levels[1].sample_count(), 0U);
  spend_day(memory, 1, 1, false);  // the first scan of the next day ends the one before
  EXPECT_EQ(share_of_box(memory, 1), 1.0);
  spend_day(memory, 1, 100, false);
  EXPECT_EQ(share_of_box(memory, 1), 1.0);
  EXPECT_EQ(share_of_box(memory, 0), 0.0);  // the short level follows at once
  memory.close_day();
  EXPECT_LT(share_of_box(memory, 1), 1.0);
}

TEST(DayLevels, TakeADaysEvenSampleNotItsEnd) {
  TimescaleMemory memory(with_daily_and_weekly());
  for (int i = 0; i < 1000; ++i) {
    memory.observe(observe({0.0, 0.0, 0.0}, 0.25 * kDay_s + i, i < 300));
  }
  memory.close_day();
  EXPECT_NEAR(share_of_box(memory, 1), 0.3, 0.15);  // 50 of the 1,000 scans
}

TEST(DayLevels, CountTheDaysBetweenTwoVisits) {
  TimescaleMemory memory(with_daily_and_weekly());
  spend_day(memory, 0, 100, true);
  spend_day(memory, 9, 100, false);
  memory.close_day();
  EXPECT_NEAR(share_of_box(memory, 1), 0.125, 0.05);
}

TEST(DayLevels, CountADayForARunWhoseClockSaysNothing) {
  TimescaleMemory memory(with_daily_and_weekly());
  spend_day(memory, 0, 100, true, 0);
  spend_day(memory, 0, 100, false, 1);  // the same stamps again
  memory.close_day();
  EXPECT_NEAR(share_of_box(memory, 1), std::exp2(-1.0 / 3.0), 0.06);
}

TEST(DayLevels, EndADayThatBeganByAClockFarAheadWhenThatIsPutRight) {
  TimescaleMemory memory(with_daily_and_weekly());
  spend_day(memory, 1000, 100, true);
  EXPECT_EQ(memory.nodes()[0].levels[1].sample_count(), 0U);
  spend_day(memory, 0, 1, false);
  EXPECT_EQ(share_of_box(memory, 1), 1.0);
  spend_day(memory, 0, 100, false);
  memory.close_day();
  EXPECT_NEAR(share_of_box(memory, 1), std::exp2(-1.0 / 3.0), 0.06) << "a day's change";
}

/// A boot without a clock of its own begins in 1970, until the network tells the time.
class AfterABootInThePast : public testing::TestWithParam<std::vector<int>> {};

TEST_P(AfterABootInThePast, TheNextDayIsOneDayLater) {
  TimescaleMemory memory(with_daily_and_weekly());
  spend_day(memory, 20000, 100, true);
  for (const int day : GetParam()) spend_day(memory, day, 5, true);
  spend_day(memory, 20001, 100, false);
  memory.close_day();
  EXPECT_NEAR(share_of_box(memory, 1), std::exp2(-1.0 / 3.0), 0.06);
  EXPECT_NEAR(share_of_box(memory, 2), std::exp2(-1.0 / 21.0), 0.06);
}

INSTANTIATE_TEST_SUITE_P(DayLevels, AfterABootInThePast,
                         testing::Values(std::vector<int>{}, std::vector<int>{0},
                                         std::vector<int>{0, 1, 2}, std::vector<int>{9, 6, 3, 0},
                                         std::vector<int>{30000, 20000, 0}));

TEST(DayLevels, CountWhatARunAddsWhoseClockBeginsSomewhatLate) {
  TimescaleMemory memory(with_daily_and_weekly());
  spend_day(memory, 0, 100, true, 0);
  for (int i = 0; i < 200; ++i) {  // from an hour before the end on, for nine hours
    PosedScan scan = observe({0.0, 0.0, 0.0}, 0.5 * kDay_s + 50.0 + 160.0 * i, false);
    scan.run = 1;
    memory.observe(scan);
  }
  memory.close_day();
  EXPECT_NEAR(share_of_box(memory, 1), std::exp2(-32000.0 / kDay_s / 3.0), 0.04);
}

TEST(DayLevels, ReadStatesOfBeforeClocksThatWereSetBackWereKnown) {
  TimescaleMemory memory(with_daily_and_weekly());
  spend_day(memory, 0, 100, true);
  TimescaleMemory::NodeState node = memory.node_state(0);
  const std::vector<std::byte> today = node.levels.back();
  node.levels.back().resize(today.size() - sizeof(std::uint64_t));  // their number, none
  const std::vector<TimescaleMemory::NodeState> nodes{node};
  EXPECT_EQ(TimescaleMemory::restore(memory.head_state(), nodes, "test").state(), memory.state());
}

TEST(DayLevels, GoOnFromTheirStateInTheMiddleOfADay) {
  TimescaleMemory memory(with_daily_and_weekly(), 7);
  spend_day(memory, 0, 100, true);
  spend_day(memory, 1, 30, false);
  std::vector<TimescaleMemory::NodeState> nodes{memory.node_state(0)};
  TimescaleMemory restored = TimescaleMemory::restore(memory.head_state(), nodes, "test");
  for (TimescaleMemory* one : {&memory, &restored}) {
    for (int i = 30; i < 60; ++i) {
      one->observe(observe({0.0, 0.0, 0.0}, 1.5 * kDay_s + i, false));
    }
    one->close_day();
  }
  EXPECT_EQ(memory.state(), restored.state());
  nodes[0].levels.pop_back();
  EXPECT_THROW((void)TimescaleMemory::restore(memory.head_state(), nodes, "test"), InputError);
}

TEST(DayLevels, AreNeverNamedAsAnotherModel) {
  TimescaleConfig config = with_daily_and_weekly();
  EXPECT_TRUE(validate(config).empty());
  config.levels[1].name = "mixture";
  EXPECT_FALSE(validate(config).empty());
}

}  // namespace
}  // namespace strata::memory
