// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag.hpp"

#include <filesystem>
#include <string>

#include "strata_idl/tf2_msgs.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/bag_storage.hpp"
#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using test::bytes_of;
using test_log::make_log;
using test_log::write_text;

class Bag : public ::testing::Test {
 protected:
  fs::path write(BagStorage storage, BagCompression compression, std::size_t scans = 60) {
    const fs::path folder = folder_.path() / "bag";
    write_bag(folder, make_log(scans, 180, 7), storage, compression);
    return folder / (storage == BagStorage::kMcap ? "bag_0.mcap" : "bag_0.db3");
  }
  strata::test::TemporaryDirectory folder_;
};

TEST_F(Bag, MessagesComeInOrderOfTheirStampsWhateverTheOrderOfWriting) {
  for (const auto storage : {BagStorage::kSqlite3, BagStorage::kMcap}) {
    const fs::path folder = folder_.path() / (storage == BagStorage::kMcap ? "m" : "s");
    BagWriter writer(folder, storage, BagCompression::kNone);
    const auto a = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    const auto b = writer.add_topic({"/b", "std_msgs/msg/String", "cdr", "qos"});
    EXPECT_EQ(writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""}), a);
    const std::vector<std::uint8_t> data = {0, 1, 0, 0, 42};
    for (const std::int64_t ns : {50, 10, 40, 20, 30}) writer.write(ns > 25 ? a : b, {ns}, data);
    writer.close();
    const auto reader = BagReader::open(folder);
    BagMessage message;
    std::vector<std::int64_t> stamps;
    while (reader->next(message)) {
      stamps.push_back(message.stamp.ns);
      EXPECT_EQ(message.data, data);
      EXPECT_EQ(reader->topics()[message.topic].name, message.stamp.ns > 25 ? "/a" : "/b");
    }
    EXPECT_THAT(stamps, ::testing::ElementsAre(10, 20, 30, 40, 50));
    EXPECT_EQ(reader->damage().count, 0U);
  }
}

TEST_F(Bag, ARecordingThatBrokeOffReadsWithoutMetadataOrSummary) {
  for (const auto storage : {BagStorage::kSqlite3, BagStorage::kMcap}) {
    const fs::path live = folder_.path() / (storage == BagStorage::kMcap ? "m" : "s");
    const fs::path copy = live.string() + "_copy";
    BagWriter writer(live, storage, BagCompression::kZstd);
    const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    const std::vector<std::uint8_t> data(300'000, 1);
    for (std::int64_t ns = 0; ns < 12; ++ns) writer.write(topic, {ns}, data);
    fs::copy(live, copy);  // what a crash would leave
    const auto reader = BagReader::open(copy);
    BagMessage message;
    std::size_t count = 0;
    while (reader->next(message)) ++count;
    EXPECT_GE(count, 8U);
    EXPECT_LE(count, 12U);
  }
}

TEST_F(Bag, AFlippedByteInAChunkCostsThatChunkAndIsReported) {
  for (const auto compression :
       {BagCompression::kNone, BagCompression::kZstd, BagCompression::kLz4}) {
    fs::remove_all(folder_.path() / "bag");
    const fs::path file = write(BagStorage::kMcap, compression, 2000);
    std::string bytes = bytes_of(file);
    const std::size_t whole = read_log(file).observations.size();
    bytes[bytes.size() / 3] = static_cast<char>(bytes[bytes.size() / 3] ^ 0x10);
    write_text(file, bytes);
    ReadReport report;
    const auto content = read_log(file, {}, &report);
    EXPECT_EQ(report.bad_lines, 1U);
    EXPECT_THAT(report.first_bad, ::testing::HasSubstr("byte "));
    EXPECT_LT(content.observations.size(), whole);
    EXPECT_GT(content.observations.size(), 0U);
  }
}

TEST_F(Bag, ACutMcapReadsUpToTheCut) {
  const fs::path file = write(BagStorage::kMcap, BagCompression::kNone, 2000);
  const std::string bytes = bytes_of(file);
  write_text(file, bytes.substr(0, bytes.size() * 3 / 4));
  ReadReport report;
  const auto content = read_log(file, {}, &report);
  EXPECT_GT(content.observations.size(), 500U);
  EXPECT_LT(content.observations.size(), 2000U);
  EXPECT_GE(report.bad_lines, 1U);
  EXPECT_THAT(report.warnings, ::testing::Contains(::testing::HasSubstr("damaged")));
}

TEST_F(Bag, ACutDatabaseIsReadInPartOrRefusedByName) {
  const fs::path file = write(BagStorage::kSqlite3, BagCompression::kNone, 1000);
  const std::string bytes = bytes_of(file);
  for (const double share : {0.01, 0.3, 0.9}) {
    write_text(file, bytes.substr(0, static_cast<std::size_t>(share * bytes.size())));
    ReadReport report;
    try {
      const auto content = read_log(file, {}, &report);
      EXPECT_LT(content.observations.size(), 1000U);
      EXPECT_GE(report.bad_lines, 1U);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("bag_0.db3"));
    }
  }
}

TEST_F(Bag, TheOldestSchemaReads) {
  const fs::path file = folder_.path() / "old.db3";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database,
                         "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT,type TEXT,"
                         "serialization_format TEXT);"
                         "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER,"
                         "timestamp INTEGER,data BLOB);"
                         "INSERT INTO topics VALUES(5,'/a','std_msgs/msg/String','cdr');"
                         "INSERT INTO messages VALUES(1,5,77,x'00010000');"
                         "INSERT INTO messages VALUES(2,6,78,x'00010000');",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  const auto reader = BagReader::open(file);
  BagMessage message;
  ASSERT_TRUE(reader->next(message));
  EXPECT_EQ(message.stamp.ns, 77);
  EXPECT_FALSE(reader->next(message));
  EXPECT_EQ(reader->damage().count, 1U) << "the message without a topic";
}

TEST_F(Bag, OdometryComesFromTfWhenThereIsNone) {
  const fs::path folder = folder_.path() / "tf";
  {
    BagWriter writer(folder, BagStorage::kMcap);
    const auto tf = writer.add_topic({"/tf", "tf2_msgs/msg/TFMessage", "cdr", ""});
    const auto scan_topic = writer.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", ""});
    for (int i = 0; i < 3; ++i) {
      const Stamp stamp{i * 100'000'000};
      tf2_msgs::msg::TFMessage message;
      message.transforms().push_back(convert::to_transform_stamped(
          stamp, {static_cast<double>(i), 0.0, 0.0}, "odom", "base_link"));
      writer.write(tf, stamp, convert::to_cdr(message));
    }
    Scan scan = make_log(1, 8, 1).observations[0].scan;
    scan.stamp = {150'000'000};
    writer.write(scan_topic, scan.stamp, convert::to_cdr(convert::to_message(scan, "base_link")));
  }
  ReadReport report;
  const auto scans = read_observations(folder, {}, &report);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(report.odometry_source, "tf");
  EXPECT_NEAR(scans[0].odom_from_robot.x, 1.5, 1e-12);
}

TEST_F(Bag, ALaserUpsideDownIsTurnedRound) {
  const fs::path folder = folder_.path() / "over";
  {
    BagWriter writer(folder, BagStorage::kMcap);
    const auto tf = writer.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", ""});
    const auto topic = writer.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", ""});
    geometry_msgs::msg::TransformStamped over =
        convert::to_transform_stamped({0}, {0.1, 0.0, 0.0}, "base_link", "laser");
    over.transform().rotation().x(1.0);
    over.transform().rotation().z(0.0);
    over.transform().rotation().w(0.0);
    tf2_msgs::msg::TFMessage message;
    message.transforms().push_back(over);
    writer.write(tf, {0}, convert::to_cdr(message));
    Scan scan;
    scan.angle_min_rad = -0.5F;
    scan.angle_increment_rad = 0.5F;
    scan.range_max_m = 10.0F;
    scan.ranges_m = {1.0F, 2.0F, 3.0F, 4.0F};
    writer.write(topic, {1}, convert::to_cdr(convert::to_message(scan, "laser")));
  }
  const auto scans = read_observations(folder);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_THAT(scans[0].scan.ranges_m, ::testing::ElementsAre(4.0F, 3.0F, 2.0F, 1.0F));
  EXPECT_FLOAT_EQ(scans[0].scan.angle_min_rad, -1.0F);
  EXPECT_FALSE(scans[0].has_odometry);
}

}  // namespace
}  // namespace strata::log
