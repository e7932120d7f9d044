// SPDX-License-Identifier: Apache-2.0
/// The files of a bag: schemas that others wrote, splits, and folders that lost something.
#include "components/log/bag_storage.hpp"

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <yaml-cpp/yaml.h>

#include "components/convert/message_definitions.hpp"
#include "components/convert/type_hash.hpp"
#include "components/log/bag.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/bag_files.hpp"
#include "tests/components/log/log_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using test_log::BagContent;
using test_log::read_bag;

constexpr const char* kTopicsBefore4 =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
    "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
    "INSERT INTO topics VALUES(3,'/a','std_msgs/msg/String','cdr','- history: 3');";
constexpr const char* kMessages =
    "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT "
    "NULL,data BLOB NOT NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
    "INSERT INTO messages VALUES(1,3,20,x'00010000');"
    "INSERT INTO messages VALUES(2,3,10,x'00010000');";
constexpr const char* kSchemaTables =
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,"
    "metadata TEXT NOT NULL);";

/// As each release of rosbag2 makes its database; written by hand, not by our writer.
TEST_F(BagFilesTest, MetadataIsOfTheReleaseThatTheStorageIsOf) {
  struct Case {
    BagOptions options;
    int version;
  };
  const Case cases[] = {
      {{.sqlite_schema = 3}, 5}, {{.sqlite_schema = 4}, 7}, {{.storage = BagStorage::kMcap}, 7}};
  for (const Case& expected : cases) {
    const fs::path bag = write(expected.options, 3);
    const YAML::Node metadata =
        YAML::LoadFile(bag / "metadata.yaml")["rosbag2_bagfile_information"];
    EXPECT_EQ(metadata["version"].as<int>(), expected.version);
    const YAML::Node topic = metadata["topics_with_message_count"][0]["topic_metadata"];
    const bool tells_types = expected.version >= 7;
    EXPECT_EQ(topic["type_description_hash"].IsDefined(), tells_types);
    EXPECT_EQ(metadata["custom_data"].IsDefined(), tells_types);
    if (tells_types) {
      // The published hash of std_msgs/msg/String.
      EXPECT_EQ(topic["type_description_hash"].as<std::string>(),
                "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
      EXPECT_TRUE(metadata["custom_data"].IsMap());
    }
    EXPECT_EQ(read_bag(bag).stamps(), numbers(3));
    fs::remove_all(bag);
  }
}

TEST_F(BagFilesTest, TheSchemasOfEveryReleaseRead) {
  const std::string schema3 =
      std::string(kSchemaTables) + "INSERT INTO schema VALUES (3,'humble');" + kTopicsBefore4;
  const std::string schema4 =
      std::string(kSchemaTables) +
      "INSERT INTO schema VALUES (4,'jazzy');"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
      "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL,"
      "type_description_hash TEXT NOT NULL);"
      "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,"
      "encoding TEXT NOT NULL,encoded_message_definition TEXT NOT NULL,"
      "type_description_hash TEXT NOT NULL);"
      "INSERT INTO topics VALUES(3,'/a','std_msgs/msg/String','cdr','- history: 3',"
      "'RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18');";
  const std::pair<std::string, const char*> cases[] = {
      {kTopicsBefore4, "before 3"}, {schema3, "schema 3 (humble)"}, {schema4, "schema 4 (jazzy)"}};
  for (const auto& [sql, description] : cases) {
    const fs::path file = folder_.path() / "bag.db3";
    fs::remove(file);
    execute(file, sql + kMessages);
    const BagContent content = read_bag(file);
    EXPECT_THAT(content.stamps(), ::testing::ElementsAre(10, 20)) << description;
    ASSERT_EQ(content.topics.size(), 1U);
    EXPECT_EQ(content.topics[0].name, "/a");
    EXPECT_EQ(content.topics[0].offered_qos_profiles, "- history: 3");
    EXPECT_EQ(content.topics[0].type_hash,
              sql == schema4
                  ? "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
                  : "");
    EXPECT_EQ(content.damage.count, 0U);
    EXPECT_THAT(content.description, ::testing::HasSubstr(description));
  }
}

TEST_F(BagFilesTest, SchemaFourCarriesTheDefinitionOfEachTypeOnce) {
  const fs::path bag = folder_.path() / "bag";
  BagWriter writer(bag, BagOptions{.sqlite_schema = 4});
  writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
  writer.add_topic({"/b", "std_msgs/msg/String", "cdr", ""});
  writer.close();
  EXPECT_THAT(read_bag(bag).description, ::testing::HasSubstr("schema 4"));
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((bag / "bag_0.db3").c_str(), &database), SQLITE_OK);
  sqlite3_stmt* rows = nullptr;
  ASSERT_EQ(sqlite3_prepare_v2(database,
                               "SELECT topic_type, encoding, encoded_message_definition FROM "
                               "message_definitions",
                               -1, &rows, nullptr),
            SQLITE_OK);
  ASSERT_EQ(sqlite3_step(rows), SQLITE_ROW);
  const auto text = [&](int column) {
    return std::string(reinterpret_cast<const char*>(sqlite3_column_text(rows, column)));
  };
  EXPECT_EQ(text(0), "std_msgs/msg/String");
  EXPECT_EQ(text(1), "ros2msg");
  EXPECT_EQ(text(2), convert::message_definition("std_msgs/msg/String"));
  EXPECT_THAT(text(2), ::testing::HasSubstr("string data"));
  EXPECT_EQ(sqlite3_step(rows), SQLITE_DONE);
  sqlite3_finalize(rows);
  sqlite3_close(database);
}

TEST_F(BagFilesTest, TypesKeepTheirHashesInSchemaFourAndMcap) {
  for (const auto storage : {BagStorage::kSqlite3, BagStorage::kMcap}) {
    const fs::path bag = folder_.path() / (storage == BagStorage::kMcap ? "mcap" : "sqlite");
    BagWriter writer(bag, BagOptions{.storage = storage, .sqlite_schema = 4});
    writer.add_topic({"/known", "std_msgs/msg/String"});
    BagTopic foreign{"/foreign", "foreign_msgs/msg/Thing"};
    foreign.type_hash = "RIHS01_00";
    writer.add_topic(foreign);
    writer.add_topic({"/unknown", "foreign_msgs/msg/Other"});
    writer.close();
    const BagContent content = read_bag(bag);
    ASSERT_EQ(content.topics.size(), 3U);
    EXPECT_EQ(content.topics[0].type_hash, convert::type_hash("std_msgs/msg/String"));
    EXPECT_EQ(content.topics[1].type_hash, "RIHS01_00");
    EXPECT_EQ(content.topics[2].type_hash, "");
  }
}

TEST_F(BagFilesTest, OneThatWasClosedBeforeAnythingCameIsEmptyAndNotDamaged) {
  for (const auto storage : {BagStorage::kSqlite3, BagStorage::kMcap}) {
    const fs::path bag = folder_.path() / (storage == BagStorage::kMcap ? "mcap" : "sqlite");
    BagWriter(bag, BagOptions{.storage = storage}).close();
    const BagContent content = read_bag(bag);
    EXPECT_TRUE(content.topics.empty());
    EXPECT_TRUE(content.stamps().empty());
    EXPECT_EQ(content.damage.count, 0U);
  }
}

TEST_F(BagFilesTest, ABagOfManyFilesIsOneBag) {
  for (const auto storage : {BagStorage::kSqlite3, BagStorage::kMcap}) {
    const fs::path bag = write({.storage = storage, .split_bytes = 10'000}, 120);
    const char* ending = storage == BagStorage::kMcap ? ".mcap" : ".db3";
    EXPECT_TRUE(fs::exists(bag / (std::string("bag_11") + ending)));
    EXPECT_FALSE(fs::exists(bag / (std::string("bag_12") + ending)));
    const BagContent content = read_bag(bag);
    EXPECT_EQ(content.stamps(), numbers(120));
    EXPECT_EQ(content.topics.size(), 1U);
    EXPECT_THAT(content.description, ::testing::HasSubstr("12 files"));
    // Without metadata.yaml the numbers in the names say the order: 2 before 10.
    fs::remove(bag / "metadata.yaml");
    EXPECT_EQ(read_bag(bag).stamps(), numbers(120));
    fs::remove_all(bag);
  }
}

TEST_F(BagFilesTest, WhereTheNextFileCannotBeMadeMessagesWaitUntilItCan) {
  for (const auto storage : {BagStorage::kSqlite3, BagStorage::kMcap}) {
    const fs::path bag = folder_.path() / "blocked";
    const std::vector<std::uint8_t> data(1'000, 1);
    BagWriter writer(bag, {.storage = storage, .split_bytes = 1});
    const std::size_t topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    writer.write(topic, {0}, data);
    const fs::path next = bag / (storage == BagStorage::kMcap ? "blocked_1.mcap" : "blocked_1.db3");
    fs::create_directory(next);
    EXPECT_THROW(writer.write(topic, {1}, data), OutputError);
    EXPECT_NO_THROW(writer.write(topic, {2}, data)) << "told already";
    EXPECT_THROW(writer.flush(), OutputError);
    EXPECT_TRUE(fs::is_directory(next)) << "what is in the way is left alone";
    fs::remove(next);
    writer.write(topic, {3}, data);
    writer.close();
    EXPECT_EQ(read_bag(bag).stamps(), numbers(4));
    fs::remove_all(bag);
  }
}

TEST_F(BagFilesTest, ABagIsSplitByTimeToo) {
  const fs::path bag = write({.storage = BagStorage::kMcap, .split_after = Duration{30}}, 90);
  EXPECT_TRUE(fs::exists(bag / "bag_2.mcap"));
  EXPECT_FALSE(fs::exists(bag / "bag_3.mcap"));
  EXPECT_EQ(read_bag(bag).stamps(), numbers(90));
  EXPECT_EQ(read_bag(bag / "bag_1.mcap").stamps().front(), 30);
}

TEST_F(BagFilesTest, ABagIsSplitByTheClockThatIsToldWhereStampsComeFromSeveral) {
  const fs::path bag = folder_.path() / "bag";
  {
    BagWriter writer(bag, {.storage = BagStorage::kMcap, .split_after = Duration{30}});
    const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    for (std::int64_t i = 0; i < 90; ++i) {
      const std::int64_t host = i % 3;  // of three hosts, whose clocks are far apart
      writer.write(topic, Stamp{host * 1'000'000 + i}, std::vector<std::uint8_t>{0, 1, 0, 0},
                   Stamp{5'000 + i});
    }
  }
  EXPECT_TRUE(fs::exists(bag / "bag_2.mcap"));
  EXPECT_FALSE(fs::exists(bag / "bag_3.mcap"));
  EXPECT_EQ(read_bag(bag / "bag_1.mcap").stamps().size(), 30U);
}

TEST_F(BagFilesTest, AFileThatIsMissingOrDestroyedCostsItselfAndIsCounted) {
  const fs::path bag = write({.storage = BagStorage::kMcap, .split_bytes = 10'000}, 40);
  fs::remove(bag / "bag_1.mcap");
  test_log::write_text(bag / "bag_2.mcap", "not a bag at all");
  const BagContent content = read_bag(bag);
  EXPECT_EQ(content.stamps().size(), 20U);
  EXPECT_EQ(content.damage.count, 2U);
  EXPECT_THAT(content.damage.first, ::testing::HasSubstr("bag_1.mcap"));
}

TEST_F(BagFilesTest, ABrokenOrForeignMetadataFileCostsNothing) {
  const fs::path bag = write({.storage = BagStorage::kMcap}, 5);
  for (const char* text :
       {"rosbag2_bagfile_information: [", "", "- 1\n- 2\n",
        "rosbag2_bagfile_information:\n  relative_file_paths: [renamed_0.mcap]\n"}) {
    test_log::write_text(bag / "metadata.yaml", text);
    EXPECT_EQ(read_bag(bag).stamps(), numbers(5)) << text;
  }
}

TEST_F(BagFilesTest, AFolderWithoutABagAndAnEmptyFileAreRefused) {
  EXPECT_THROW((void)BagReader::open(folder_.path()), InputError);
  test_log::write_text(folder_.path() / "empty.db3", "");
  EXPECT_THROW((void)BagReader::open(folder_.path()), InputError);
  EXPECT_THROW((void)BagReader::open(folder_.path() / "none.mcap"), InputError);
}

TEST_F(BagFilesTest, SomebodyWhoLooksIntoItDoesNotEndTheRecording) {
  std::atomic<int> number = 0;
  std::atomic<int> looks = 0;
  const auto name = [&] { return "bag" + std::to_string(number); };
  const std::jthread looker([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      sqlite3* database = nullptr;
      const fs::path file = folder_.path() / name() / (name() + "_0.db3");
      sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
      const char* sql = "SELECT count(*) FROM sqlite_master";
      if (sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK) ++looks;
      sqlite3_close(database);
    }
  });
  for (; number < 50; ++number) {
    EXPECT_EQ(read_bag(write({}, 5, name())).stamps(), numbers(5)) << number;
  }
  EXPECT_GT(looks, 0);
}

TEST_F(BagFilesTest, WhatWasFlushedSurvivesACrash) {
  for (const auto storage : {BagStorage::kSqlite3, BagStorage::kMcap}) {
    const fs::path bag = folder_.path() / (storage == BagStorage::kMcap ? "m" : "s");
    BagWriter writer(bag, storage);
    const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    const std::vector<std::uint8_t> data(10, 0);
    for (std::int64_t i = 0; i < 3; ++i) writer.write(topic, {i}, data);
    writer.flush();
    const fs::path copy = bag.string() + "_copy";
    fs::copy(bag, copy);  // what a crash would leave
    EXPECT_EQ(read_bag(copy).stamps(), numbers(3));
    writer.write(topic, {3}, data);
    writer.close();
    EXPECT_EQ(read_bag(bag).stamps(), numbers(4));
  }
}

}  // namespace
}  // namespace strata::log
