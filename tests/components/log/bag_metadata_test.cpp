// SPDX-License-Identifier: Apache-2.0
/// What metadata.yaml says of a bag.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "components/log/bag.hpp"
#include "components/log/bag_storage.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr std::int64_t kBegin_ns = 1'700'000'000'000'000'000;

std::int64_t begin_ns(const YAML::Node& node) {
  return node["starting_time"]["nanoseconds_since_epoch"].as<std::int64_t>();
}
std::int64_t duration_ns(const YAML::Node& node) {
  return node["duration"]["nanoseconds"].as<std::int64_t>();
}

class BagMetadata : public ::testing::TestWithParam<BagStorage> {
 protected:
  /// Five messages on /a and two on /b, ten bytes each and not in the order of their stamps;
  /// /silent has none.
  void write(std::uint64_t split_bytes) {
    BagWriter writer(bag(), BagOptions{.storage = GetParam(), .split_bytes = split_bytes});
    const auto a = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", "of a"});
    const auto b = writer.add_topic({"/b", "strange_msgs/msg/Thing", "cdr", "of b"});
    writer.add_topic({"/silent", "std_msgs/msg/String", "cdr", ""});
    const std::vector<std::uint8_t> data(10, 1);
    writer.write(a, {kBegin_ns + 300}, data);
    writer.write(a, {kBegin_ns + 100}, data);
    writer.write(b, {kBegin_ns + 400}, data);
    writer.write(a, {kBegin_ns + 900}, data);
    writer.write(a, {kBegin_ns + 700}, data);
    writer.write(b, {kBegin_ns + 500}, data);
    writer.write(a, {kBegin_ns + 800}, data);
    writer.close();
  }
  [[nodiscard]] fs::path bag() const { return folder_.path() / "bag"; }
  [[nodiscard]] YAML::Node info() const {
    return YAML::LoadFile(bag() / "metadata.yaml")["rosbag2_bagfile_information"];
  }
  [[nodiscard]] static std::string file_name(int number) {
    const char* ending = GetParam() == BagStorage::kMcap ? ".mcap" : ".db3";
    return "bag_" + std::to_string(number) + ending;
  }
  /// The same whether the bag is split or not.
  void expect_the_bag() const {
    const YAML::Node bag = info();
    EXPECT_EQ(bag["storage_identifier"].as<std::string>(),
              GetParam() == BagStorage::kMcap ? "mcap" : "sqlite3");
    EXPECT_EQ(begin_ns(bag), kBegin_ns + 100);
    EXPECT_EQ(duration_ns(bag), 800);
    EXPECT_EQ(bag["message_count"].as<int>(), 7);
    EXPECT_EQ(bag["compression_format"].as<std::string>(), "");
    EXPECT_EQ(bag["compression_mode"].as<std::string>(), "");
    const YAML::Node topics = bag["topics_with_message_count"];
    ASSERT_EQ(topics.size(), 3U);
    const char* const names[] = {"/a", "/b", "/silent"};
    const char* const types[] = {"std_msgs/msg/String", "strange_msgs/msg/Thing",
                                 "std_msgs/msg/String"};
    const char* const qos[] = {"of a", "of b", ""};
    const int counts[] = {5, 2, 0};
    for (std::size_t i = 0; i < 3; ++i) {
      const YAML::Node topic = topics[i]["topic_metadata"];
      EXPECT_EQ(topic["name"].as<std::string>(), names[i]);
      EXPECT_EQ(topic["type"].as<std::string>(), types[i]);
      EXPECT_EQ(topic["serialization_format"].as<std::string>(), "cdr");
      EXPECT_EQ(topic["offered_qos_profiles"].as<std::string>(), qos[i]);
      EXPECT_EQ(topics[i]["message_count"].as<int>(), counts[i]);
    }
  }
  struct File {
    std::int64_t begin_ns;
    std::int64_t duration_ns;
    int messages;
  };
  void expect_files(const std::vector<File>& expected) const {
    const YAML::Node bag = info();
    ASSERT_EQ(bag["files"].size(), expected.size());
    ASSERT_EQ(bag["relative_file_paths"].size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const std::string name = file_name(static_cast<int>(i));
      EXPECT_TRUE(fs::exists(this->bag() / name)) << name;
      EXPECT_EQ(bag["relative_file_paths"][i].as<std::string>(), name);
      const YAML::Node file = bag["files"][i];
      EXPECT_EQ(file["path"].as<std::string>(), name);
      EXPECT_EQ(begin_ns(file), kBegin_ns + expected[i].begin_ns) << name;
      EXPECT_EQ(duration_ns(file), expected[i].duration_ns) << name;
      EXPECT_EQ(file["message_count"].as<int>(), expected[i].messages) << name;
    }
  }

 private:
  strata::test::TemporaryDirectory folder_;
};

TEST_P(BagMetadata, TellsTimesCountsAndTheFileOfAWholeBag) {
  write(0);
  expect_the_bag();
  expect_files({{100, 800, 7}});
}

TEST_P(BagMetadata, TellsTimesAndCountsOfEachFileOfASplitBag) {
  write(20);  // two messages
  expect_the_bag();
  expect_files({{100, 200, 2}, {400, 500, 2}, {500, 200, 2}, {800, 0, 1}});
}

TEST_P(BagMetadata, OfABagWithoutMessagesTellsThatThereAreNone) {
  BagWriter(bag(), GetParam()).close();
  EXPECT_EQ(info()["message_count"].as<int>(), 0);
  EXPECT_EQ(begin_ns(info()), 0);
  EXPECT_EQ(duration_ns(info()), 0);
  EXPECT_EQ(info()["topics_with_message_count"].size(), 0U);
  EXPECT_EQ(info()["files"][0]["message_count"].as<int>(), 0);
}

TEST_P(BagMetadata, HidesNothingThatComesAfterASplitWhenTheProcessIsKilledThen) {
  BagWriter writer(bag(), GetParam());
  const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
  const std::vector<std::uint8_t> data(10, 1);
  writer.write(topic, {kBegin_ns}, data);
  writer.close();
  EXPECT_EQ(bag_files(bag()).files.size(), 1U);
  writer.write(topic, {kBegin_ns + 1}, data);
  writer.flush();
  EXPECT_EQ(bag_files(bag()).files.size(), 2U);  // as after a kill: nothing is closed
}

INSTANTIATE_TEST_SUITE_P(All, BagMetadata,
                         ::testing::Values(BagStorage::kSqlite3, BagStorage::kMcap),
                         [](const auto& each) {
                           return each.param == BagStorage::kMcap ? "Mcap" : "Sqlite3";
                         });

}  // namespace
}  // namespace strata::log
