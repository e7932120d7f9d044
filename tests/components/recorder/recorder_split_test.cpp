// SPDX-License-Identifier: Apache-2.0
/// When a recorder begins another file of its bag.
#include <chrono>
#include <filesystem>
#include <iterator>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "tests/components/recorder/recorder_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::recorder {
namespace {

TEST_P(RecorderStorage, BeginsAnotherFileWhenOneIsLargeEnough) {
  auto scans = writer("/scan", "default");
  const auto host = make(", split_mb: 0.002");
  host->activate();
  for (int i = 0; i < 20; ++i) scans.publish(numbered(i));
  host->stop();
  EXPECT_GT(std::distance(std::filesystem::directory_iterator(bag()), {}), 3);
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 20U);
}

TEST_P(RecorderStorage, BeginsAnotherFileWhenOneSpansTheTime) {
  auto scans = writer("/scan", "default");
  const auto host =
      make(", split_s: 1e-9, topics: [/scan]");  // less than any two messages are apart
  host->activate();
  for (int i = 0; i < 10; ++i) scans.publish(numbered(i));
  host->stop();
  const YAML::Node files =
      YAML::LoadFile((bag() / "metadata.yaml").string())["rosbag2_bagfile_information"]["files"];
  ASSERT_EQ(files.size(), 10U);
  for (const YAML::Node& file : files) EXPECT_EQ(file["message_count"].as<int>(), 1);
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 10U);
}

TEST_P(RecorderStorage, BeginsAnotherFileWhenItIsAskedTo) {
  auto scans = writer("/scan", "default");
  const auto host = make(", topics: [/scan]");
  host->activate();
  for (const int number : {1, 2, 3}) {
    scans.publish(numbered(number));
    call<bus::srv::SplitBagfile>("split_bagfile");
    call<bus::srv::SplitBagfile>("split_bagfile");  // nothing has come that would need a file
  }
  scans.publish(numbered(4));
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  const YAML::Node info =
      YAML::LoadFile((bag() / "metadata.yaml").string())["rosbag2_bagfile_information"];
  ASSERT_EQ(info["files"].size(), 4U);
  for (const YAML::Node& file : info["files"]) EXPECT_EQ(file["message_count"].as<int>(), 1);
  EXPECT_EQ(read_bag(bag()).at("/scan").size(), 4U);
}

/// Where time has to pass: with one storage only.
class RecorderOverTime : public RecorderStorage {};

TEST_P(RecorderOverTime, BeginsNoOtherFileForWhatIsOldWhenItComes) {
  constexpr auto kSplit = std::chrono::seconds(5);
  auto map = writer("/map", "latched");
  auto scans = writer("/scan", "default");
  map.publish(numbered(1));
  std::this_thread::sleep_for(kSplit + std::chrono::milliseconds(100));
  const auto host = make(", split_s: 5.0, topics: [/map, /scan]");
  const std::int64_t configured_ns = now_ns();
  host->activate();
  ASSERT_TRUE(test::comes_true([&] {  // the map is recorded
    return host->components().front()->counts().processed == 1;
  }));
  for (const int number : {2, 3}) scans.publish(numbered(number));
  host->stop();
  const YAML::Node info =
      YAML::LoadFile((bag() / "metadata.yaml").string())["rosbag2_bagfile_information"];
  const YAML::Node files = info["files"];
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0]["message_count"].as<int>(), 3);
  // What is latched stands where the recording begins, not where it was published: a player waits
  // between stamps.
  EXPECT_GE(info["starting_time"]["nanoseconds_since_epoch"].as<std::int64_t>(), configured_ns);
  EXPECT_LT(info["duration"]["nanoseconds"].as<std::int64_t>(), 2'000'000'000);
}

INSTANTIATE_TEST_SUITE_P(All, RecorderOverTime,
                         testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::recorder
