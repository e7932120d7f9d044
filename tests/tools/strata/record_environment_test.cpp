// SPDX-License-Identifier: Apache-2.0
/// Where `strata record` looks: where ROS 2's variables say, as `strata run` does.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "components/bus/endpoint.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

constexpr auto kPatience = std::chrono::seconds(60);
constexpr const char* kHearsNobody = "note: no other process is heard";

class RecordEnvironment : public testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<test::ChildProcess> record(
      const std::vector<std::string>& environment,
      const std::vector<std::string>& more = {}) const {
    std::vector<std::string> command = {STRATA_PROGRAM, "record",
                                        "--out",        (folder_.path() / "bag").string(),
                                        "--topics",     "/scan:sensor_msgs/msg/LaserScan"};
    command.insert(command.end(), more.begin(), more.end());
    std::vector<std::string> all = {"ROS_DOMAIN_ID=" + std::to_string(test::own_domain())};
    all.insert(all.end(), environment.begin(), environment.end());
    return std::make_unique<test::ChildProcess>(command, all, test::ChildProcess::Errors::kMerged);
  }
  /// Records from a talker on the loopback interface.
  void expect_meets_loopback(test::ChildProcess& recorder) const {
    EXPECT_NE(recorder.wait_for_line("recording into", kPatience), "");
    const auto bytes = [this] {  // SQLite writes beside its file first
      std::uintmax_t sum = 0;
      for (const auto& entry : fs::directory_iterator(folder_.path() / "bag")) {
        sum += entry.file_size();
      }
      return sum;
    };
    const auto before = bytes();
    bus::Writer<sensor_msgs::msg::LaserScan> talker(test::make_participant(), "/scan",
                                                    bus::qos_profile("sensor_data"));
    EXPECT_TRUE(test::comes_true([&] {
      talker.publish({});
      return bytes() > before;
    }));
    recorder.send(SIGINT);
    EXPECT_EQ(recorder.wait(), 0) << recorder.rest();
  }
  void expect_error(const std::string& variable, const std::string& what) const {
    const auto recorder = record({variable});
    const std::string said = recorder->rest();
    EXPECT_EQ(recorder->wait(), 2) << said;
    EXPECT_NE(said.find("strata record: error: " + what), std::string::npos) << said;
  }
  const test::TemporaryDirectory folder_;
};

TEST_F(RecordEnvironment, SaysDomainAndTransport) {
  const auto recorder = record({"ROS_LOCALHOST_ONLY=1", "ROS_DISTRO=humble"});
  expect_meets_loopback(*recorder);
}

TEST_F(RecordEnvironment, YieldsToOptions) {
  const auto recorder = record({"ROS_AUTOMATIC_DISCOVERY_RANGE=OFF"}, {"--transport", "loopback"});
  expect_meets_loopback(*recorder);
  EXPECT_EQ(recorder->rest().find(kHearsNobody), std::string::npos);
}

TEST_F(RecordEnvironment, SaysThatItHearsNobodyWhereTheRangeIsOff) {
  const auto recorder = record({"ROS_AUTOMATIC_DISCOVERY_RANGE=OFF"});
  EXPECT_THAT(recorder->wait_for_line(kHearsNobody, kPatience),
              testing::HasSubstr("ROS_AUTOMATIC_DISCOVERY_RANGE=OFF"));
  ASSERT_NE(recorder->wait_for_line("recording into", kPatience), "");
  recorder->send(SIGINT);
  EXPECT_EQ(recorder->wait(), 1) << "it lacks what it was asked for";
  EXPECT_EQ(recorder->rest().find(kHearsNobody), std::string::npos) << "said twice";
}

TEST_F(RecordEnvironment, SaysRangePeersAndRelease) {
  expect_error("ROS_AUTOMATIC_DISCOVERY_RANGE=MOON", "ROS_AUTOMATIC_DISCOVERY_RANGE: is 'MOON'");
  expect_error("ROS_STATIC_PEERS=robot one", "static peer 'robot one': has no IPv4 address");
  expect_error("ROS_DISTRO=jazy", "ROS_DISTRO: unknown ROS 2 release 'jazy'");
}

TEST_F(RecordEnvironment, WhereNobodyPublishesATopicIsToldAndFails) {
  const auto recorder = record({}, {"/nothing", "--transport", "loopback"});
  ASSERT_NE(recorder->wait_for_line("recording into", kPatience), "");
  recorder->send(SIGINT);
  EXPECT_EQ(recorder->wait(), 1);
  EXPECT_THAT(recorder->rest(),
              testing::HasSubstr("lacks what nobody published: /nothing, /scan; name topics"));
}

}  // namespace
}  // namespace strata::tools
