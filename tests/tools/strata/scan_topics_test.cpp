// SPDX-License-Identifier: Apache-2.0
/// `strata info` and `strata convert` of bags with several scanners.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/convert/cdr.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::quoted;
using test::run_strata;
using ::testing::HasSubstr;

const Pose2 kFront{0.2, 0.0, 0.0};
const Pose2 kBack{-0.3, 0.0, 3.0};

Scan scan_at(int step, std::size_t beams) {
  Scan scan;
  scan.stamp = Stamp{1'000'000'000'000 + step * 100'000'000LL};
  scan.angle_min_rad = -1.0F;
  scan.angle_increment_rad = 0.01F;
  scan.range_max_m = 20.0F;
  for (std::size_t i = 0; i < beams; ++i)
    scan.ranges_m.push_back(2.0F + 0.01F * static_cast<float>(i));
  return scan;
}

/// 20 scans of 100 beams on /scan, 10 of 50 on /back/scan.
class ScanTopics : public testing::Test {
 protected:
  void SetUp() override {
    log::LogContent content;
    content.scan_frame = "front";
    log::LogExtras extras;
    extras.mountings.push_back({"back", lift(kBack)});
    extras.topics.push_back({"/back/scan", "sensor_msgs/msg/LaserScan", "cdr", ""});
    for (int step = 0; step < 20; ++step) {
      Observation observation{0, scan_at(step, 100), Pose2{0.1 * step, 0.0, 0.0}, true};
      observation.scan.robot_from_laser = kFront;
      content.observations.push_back(observation);
      if (step % 2 != 0) continue;
      Scan back = scan_at(step, 50);
      back.stamp = back.stamp + Duration::from_seconds(0.03);
      extras.messages.push_back(
          {0, back.stamp, convert::to_cdr(convert::to_message(back, "back"))});
    }
    log::write_bag(bag(), content, log::BagOptions{}, extras);
  }
  [[nodiscard]] fs::path bag() const { return folder_.path() / "bag"; }
  [[nodiscard]] std::string at(const std::string& name) const {
    return quoted(folder_.path() / name);
  }
  test::TemporaryDirectory folder_;
};

TEST_F(ScanTopics, InfoTellsOfTheOneThatIsNamed) {
  const json info =
      json::parse(run_strata("info --json --quiet --scan-topic /back/scan " + at("bag")).out);
  EXPECT_EQ(info["scans"]["count"], 10);
  EXPECT_EQ(info["scans"]["beams"], 50);
  EXPECT_EQ(info["scans"]["mounting"], json({-0.3, 0.0, 3.0}));
  EXPECT_FALSE(info.contains("scanners"));
}

TEST_F(ScanTopics, InfoTellsOfEachOfSeveral) {
  const std::string command = "info --scan-topic /scan --scan-topic /back/scan " + at("bag");
  const json info = json::parse(run_strata(command + " --quiet --json").out);
  EXPECT_EQ(info["scans"]["count"], 30);
  ASSERT_EQ(info["scanners"].size(), 2U);
  EXPECT_EQ(info["scanners"][0]["topic"], "/scan");
  EXPECT_EQ(info["scanners"][0]["count"], 20);
  EXPECT_EQ(info["scanners"][1]["topic"], "/back/scan");
  EXPECT_EQ(info["scanners"][1]["beams"], 50);
  EXPECT_EQ(info["scanners"][1]["mounting"], json({-0.3, 0.0, 3.0}));
  const auto told = run_strata(command + " 2>&1");
  EXPECT_EQ(told.code, 0);
  EXPECT_THAT(told.out, HasSubstr("  scanner    /scan: 20 scans, "));
  EXPECT_THAT(told.out, HasSubstr("  scanner    /back/scan: 10 scans, "));
  EXPECT_THAT(told.out, HasSubstr("sits at -0.300 m, 0.000 m, 3.0000 rad\n"));
}

TEST_F(ScanTopics, InfoRefusesOneThatIsNotThere) {
  const auto told = run_strata("info --scan-topic /nobody " + at("bag") + " 2>&1");
  EXPECT_EQ(told.code, 2);
  EXPECT_THAT(told.out, HasSubstr("holds no readable scan on /nobody"));
}

TEST_F(ScanTopics, ConvertTakesTheOneThatIsNamed) {
  const auto told =
      run_strata("convert --scan-topic /back/scan " + at("bag") + " " + at("b.clf") + " 2>&1");
  ASSERT_EQ(told.code, 0) << told.out;
  EXPECT_THAT(told.out, HasSubstr("left out, the target has no place for it: /scan (20 "));
  const auto back = log::read_observations(folder_.path() / "b.clf");
  ASSERT_EQ(back.size(), 10U);
  EXPECT_EQ(back.front().scan.size(), 50U);
  EXPECT_EQ(back.front().scan.robot_from_laser, kBack);
}

// A CARMEN log would read as one scanner with one mounting, which is neither's.
TEST_F(ScanTopics, ConvertRefusesSeveralForACarmenLog) {
  const auto told = run_strata("convert --scan-topic /scan --scan-topic /back/scan " + at("bag") +
                               " " + at("b.clf") + " 2>&1");
  EXPECT_EQ(told.code, 2);
  EXPECT_THAT(told.out, HasSubstr("has several scanners, and a CARMEN log holds one"));
  EXPECT_FALSE(fs::exists(folder_.path() / "b.clf"));
}

TEST_F(ScanTopics, AreRefusedWhereTheyMeanNothing) {
  ASSERT_EQ(run_strata("convert --quiet " + at("bag") + " " + at("a.clf") + " 2>&1").code, 0);
  const auto carmen = run_strata("info --scan-topic /scan " + at("a.clf") + " 2>&1");
  EXPECT_EQ(carmen.code, 2);
  EXPECT_THAT(carmen.out, HasSubstr("is a CARMEN log"));
  const auto copy =
      run_strata("convert --scan-topic /scan " + at("bag") + " " + at("copy.mcap") + " 2>&1");
  EXPECT_EQ(copy.code, 2);
  EXPECT_THAT(copy.out, HasSubstr("a bag keeps every topic"));
  const auto cut =
      run_strata("convert --min-height 0.4 " + at("bag") + " " + at("copy.mcap") + " 2>&1");
  EXPECT_EQ(cut.code, 2);
  EXPECT_THAT(cut.out, HasSubstr("a bag keeps clouds as they are"));
}

}  // namespace
}  // namespace strata::tools
