// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/year.hpp"

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "memory/store/store.hpp"
#include "tests/support/test_data.hpp"

namespace strata::experiments {
namespace {

TEST(Year, LetsEachRobotGoOnFromItsOwnPosesAndKeepsTheMemoryOnDisk) {
  const test::TemporaryDirectory out;
  YearOptions options;
  options.scenario = std::string(STRATA_SCENARIO_DIR) + "/year.yaml";
  options.overrides = {"robot.laps=1", "laser.rate_hz=4"};
  options.days = 3;
  options.particles = 200;
  options.out = out.path();
  std::vector<YearDay> days;
  run_year(options, [&](const YearDay& day) { days.push_back(day); });
  ASSERT_EQ(days.size(), 2U);
  for (const YearDay& day : days) {
    ASSERT_EQ(day.tracks.size(), 3U);
    for (const YearTrack& track : day.tracks) {
      EXPECT_GT(track.scans, 300U);
      EXPECT_EQ(track.failures, 0U) << track.name << ", day " << day.day;
      EXPECT_LT(track.error_m, 0.2) << track.name << ", day " << day.day;
    }
  }
  EXPECT_GE(days[1].nodes, days[0].nodes);
  EXPECT_GE(days[1].store_mb, days[0].store_mb);
  const memory::Store store(out.path() / "strata.db", {.read_only = true});
  EXPECT_EQ(store.load_timescale().nodes().size(), days.back().nodes);
  EXPECT_GT(store.load_timescale().observations(), days.back().nodes);
}

}  // namespace
}  // namespace strata::experiments
