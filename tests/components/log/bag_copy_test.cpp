// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag_copy.hpp"

#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using Entry = std::tuple<std::int64_t, std::string, std::string, std::string, std::string,
                         std::vector<std::uint8_t>>;

std::vector<Entry> read_all(const fs::path& path) {
  const auto reader = BagReader::open(path);
  std::vector<Entry> entries;
  BagMessage message;
  while (reader->next(message)) {
    const BagTopic& topic = reader->topics()[message.topic];
    entries.emplace_back(message.stamp.ns, topic.name, topic.type, topic.serialization_format,
                         topic.offered_qos_profiles, message.data);
  }
  return entries;
}

class BagCopy : public ::testing::Test {
 protected:
  /// A laser log and topics of types that nobody here knows.
  fs::path write() {
    const fs::path bag = folder_.path() / "in";
    BagWriter writer(bag, BagStorage::kSqlite3);
    const auto latched =
        writer.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", recorded_qos(true)});
    const auto scan = writer.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", "- depth: 5"});
    const auto foreign = writer.add_topic({"/weld", "acme_msgs/msg/Weld", "cdr", ""});
    const auto json = writer.add_topic({"/notes", "acme_msgs/msg/Note", "json", ""});
    writer.add_topic({"/silent", "acme_msgs/msg/Never", "cdr", ""});
    const auto bytes = [](std::int64_t i) {
      return std::vector<std::uint8_t>{0, 1, 0, 0, static_cast<std::uint8_t>(i), 0xFF};
    };
    writer.write(latched, {500}, bytes(1));
    for (std::int64_t i = 1; i <= 20; ++i) {
      writer.write(scan, {i * 1'000'000'000}, bytes(i));
      writer.write(foreign, {i * 1'000'000'000 + 7}, bytes(i + 100));
      writer.write(json, {i * 1'000'000'000 + 8}, bytes(i + 50));
    }
    writer.close();
    return bag;
  }
  strata::test::TemporaryDirectory folder_;
};

TEST_F(BagCopy, ThroughEveryStorageAndBackEveryMessageOfEveryTypeIsTheSame) {
  const fs::path in = write();
  const auto original = read_all(in);
  int count = 0;
  const BagOptions formats[] = {
      {.storage = BagStorage::kMcap, .chunks = BagCompression::kZstd},
      {.storage = BagStorage::kMcap, .chunks = BagCompression::kLz4},
      {.storage = BagStorage::kMcap, .packing = BagPacking::kMessage},
      {.storage = BagStorage::kSqlite3, .packing = BagPacking::kFile, .sqlite_schema = 4},
      {.storage = BagStorage::kSqlite3, .split_bytes = 40}};
  for (const BagOptions& format : formats) {
    const fs::path there = folder_.path() / ("there" + std::to_string(count));
    const fs::path back = folder_.path() / ("back" + std::to_string(count++));
    const CopyReport report = copy_bag(in, there, format);
    EXPECT_EQ(report.messages.at("/weld"), 20U);
    EXPECT_EQ(report.messages.at("/silent"), 0U);
    EXPECT_EQ(report.first_topic_of_scans, "/scan");
    EXPECT_EQ(report.damage.count, 0U);
    (void)copy_bag(there, back, BagOptions{});
    EXPECT_EQ(read_all(there), original);
    EXPECT_EQ(read_all(back), original);
    EXPECT_EQ(BagReader::open(back)->topics().size(), 5U) << "a silent topic is a topic";
  }
}

TEST_F(BagCopy, WhatABagSaysAboutAForeignTypeGoesWithIt) {
  const fs::path in = folder_.path() / "in";
  {
    BagWriter writer(in, BagStorage::kMcap);
    writer.write(writer.add_topic({"/weld", "acme_msgs/msg/Weld", "cdr", "", "float64 amps\n"}),
                 {1}, std::vector<std::uint8_t>{0, 1, 0, 0});
  }
  (void)copy_bag(in, folder_.path() / "four", BagOptions{.sqlite_schema = 4});
  (void)copy_bag(folder_.path() / "four", folder_.path() / "mcap", {.storage = BagStorage::kMcap});
  for (const char* name : {"four", "mcap"}) {
    const auto reader = BagReader::open(folder_.path() / name);
    EXPECT_EQ(reader->topics().at(0).definition, "float64 amps\n") << name;
    EXPECT_EQ(reader->topics().at(0).definition_encoding, "ros2msg");
  }
}

TEST_F(BagCopy, ACutKeepsTheLatchedTransforms) {
  const fs::path out = folder_.path() / "out";
  const CopyReport report = copy_bag(write(), out, BagOptions{.storage = BagStorage::kMcap},
                                     {.from_s = 5.0, .to_s = 8.0});
  EXPECT_EQ(report.messages.at("/scan"), 4U);
  EXPECT_EQ(report.messages.at("/weld"), 3U);
  EXPECT_EQ(report.messages.at("/tf_static"), 1U);
  EXPECT_EQ(std::get<0>(read_all(out).front()), 6'000'000'000);
}

TEST_F(BagCopy, ACutThatLeavesNothingIsRefusedAndLeavesNothing) {
  const fs::path out = folder_.path() / "out";
  const fs::path in = write();
  EXPECT_THROW((void)copy_bag(in, out, BagOptions{}, {.from_s = 100.0, .to_s = 90.0}), InputError);
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST(RealBags, CopiedToAnotherStorageHoldTheSameMessages) {
  STRATA_REQUIRE_DATA(olin, "olin_mac/take_2_db3");
  STRATA_REQUIRE_DATA(wean, "wean_hall/ros2_run2/ros2_mcap_zstd");
  const strata::test::TemporaryDirectory folder;
  for (const fs::path& in : {olin, wean}) {
    const fs::path mcap = folder.path() / (in.filename().string() + "_mcap");
    const fs::path sqlite = folder.path() / (in.filename().string() + "_db3");
    (void)copy_bag(in, mcap, {.storage = BagStorage::kMcap, .chunks = BagCompression::kZstd});
    (void)copy_bag(mcap, sqlite, {});
    const auto original = read_all(in);
    EXPECT_GT(original.size(), 2000U);
    EXPECT_EQ(read_all(mcap), original);
    EXPECT_EQ(read_all(sqlite), original);
  }
}

}  // namespace
}  // namespace strata::log
