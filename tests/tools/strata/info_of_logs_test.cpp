// SPDX-License-Identifier: Apache-2.0
/// `strata info` of logs, and from where on it takes readings for no return.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"
#include "tests/tools/strata/small_logs.hpp"
#include "tools/strata/run_options.hpp"

namespace strata::tools {
namespace {

using test::Outcome;
using test::quoted;
using test::ros1_bag;
using test::run_strata;
using test::write_log;

TEST(InfoOfLogs, StatesCountsAndGeometryAsJson) {
  const test::TemporaryDirectory folder;
  write_log(folder.path() / "a.clf", 11);
  const Outcome outcome = run_strata("info --json --quiet " + quoted(folder.path() / "a.clf"));
  ASSERT_EQ(outcome.code, 0);
  const auto info = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(info["scans"]["count"], 11);
  EXPECT_EQ(info["scans"]["beams"], 4);
  EXPECT_EQ(info["scans"]["no_returns"], 11);
  EXPECT_DOUBLE_EQ(info["scans"]["rate_hz"], 1.0);
  EXPECT_DOUBLE_EQ(info["duration_s"], 10.0);
  EXPECT_NEAR(info["path_m"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(info["messages"]["ODOM"]["count"], 11);
  EXPECT_NEAR(info["scans"]["mounting"][0].get<double>(), 0.2, 1e-9);
}

TEST(InfoOfLogs, NamesABagOfRos1AndItsTopics) {
  const Outcome text = run_strata("info --quiet " + quoted(ros1_bag()));
  ASSERT_EQ(text.code, 0) << text.out;
  EXPECT_THAT(text.out, ::testing::HasSubstr(": ROS 1 bag (ROSBAG V2.0, chunks packed with lz4)"));
  const auto info =
      nlohmann::json::parse(run_strata("info --json --quiet " + quoted(ros1_bag())).out);
  EXPECT_EQ(info["scans"]["count"], 3);
  EXPECT_EQ(info["messages"]["/scan"]["type"], "sensor_msgs/msg/LaserScan");
  EXPECT_EQ(info["bad"]["count"], 0);
}

TEST(InfoOfLogs, SaysWhatItTakesForNoReturnAndWhy) {
  const test::TemporaryDirectory folder;
  const auto write = [&](const std::string& code) {
    std::ofstream out(folder.path() / "a.clf");
    for (int i = 0; i < 30; ++i) {
      out << "FLASER 8 1 2 " << code << " " << code << " " << code << " " << code << " " << code
          << " " << code << " " << 0.1 * i << " 0 0 " << 0.1 * i << " 0 0 " << i << ".75 h 0\n";
    }
  };
  const auto info = [&](const std::string& options) {
    return run_strata("info --quiet " + quoted(folder.path() / "a.clf") + options).out;
  };
  write("81.83");
  EXPECT_THAT(info(""), ::testing::HasSubstr("no return  from 80.00 m on: as a SICK"));
  write("50.07");
  EXPECT_THAT(info(""), ::testing::HasSubstr("no return  from 50.07 m on: they pile up: 180 "
                                             "readings of exactly 50.07 m"));
  EXPECT_THAT(info(" --max-range 2.5"), ::testing::HasSubstr("no return  from 2.50 m on: as told"));
  const auto told = nlohmann::json::parse(info(" --json --max-range 70"));
  EXPECT_EQ(told["scans"]["no_returns"], 0);
  EXPECT_EQ(told["no_return"][0]["from_m"], 70.0);
}

TEST(InfoOfLogs, TheSettingsSayFromWhereOnNothingCameBack) {
  const test::TemporaryDirectory folder;
  write_log(folder.path() / "a.clf", 30);
  const std::string wrong = "learn " + quoted(folder.path() / "a.clf") + " --out " +
                            quoted(folder.path() / "maps") + " --set log.max_range_m=";
  EXPECT_THAT(run_strata(wrong + "-1 2>&1").out, ::testing::HasSubstr("log.max_range_m"));
  EXPECT_EQ(run_strata(wrong + "-1 2>&1").code, 2);
  // The option goes before them.
  pipeline::RunsInput input;
  input.logs = {(folder.path() / "a.clf").string()};
  const auto limit = [&] {
    return pipeline::read_runs(with_config(input, {2.5}), nullptr).reports[0].no_returns[0].from_m;
  };
  EXPECT_EQ(limit(), 2.5F);
  input.max_range_m = 1.5;
  EXPECT_EQ(limit(), 1.5F);
}

}  // namespace
}  // namespace strata::tools
