// SPDX-License-Identifier: Apache-2.0
/// A bag that is being written when the disk gets full, and when there is room again.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "components/log/bag.hpp"
#include "core/base/error.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr std::size_t kSmall = 200;
/// Larger than what a bag keeps in memory until there is room.
constexpr std::size_t kHuge = 2U << 20U;

struct Format {
  const char* name;
  BagOptions options;
};

class BagOnAFullDisk : public ::testing::TestWithParam<Format> {
 protected:
  BagOnAFullDisk() { (void)bag_.add_topic({"/first", "std_msgs/msg/String"}); }

  void write(std::uint8_t number, std::size_t bytes = kSmall, std::size_t topic = 0) {
    std::vector<std::uint8_t> message(bytes);
    std::uint32_t noise = number;  // does not become small when it is packed
    for (std::uint8_t& byte : message) {
      byte = static_cast<std::uint8_t>(noise >> 24U);
      noise = noise * 1'664'525U + 1'013'904'223U;
    }
    message.front() = number;
    bag_.write(topic, Stamp{std::int64_t{number}}, message);
  }
  void write_some(std::uint8_t first, std::uint8_t last) {
    for (std::uint8_t i = first; i <= last; ++i) write(i);
  }
  [[nodiscard]] fs::path folder() const { return folder_.path() / "bag"; }
  /// What is in it, each message by its number, in order; counts of metadata.yaml must agree.
  [[nodiscard]] std::vector<int> content() const {
    std::vector<int> numbers;
    std::map<std::string, int> by_topic;
    const auto reader = BagReader::open(folder());
    for (BagMessage message; reader->next(message);) {
      numbers.push_back(message.data.at(0));
      EXPECT_EQ(message.stamp.ns, numbers.back());
      ++by_topic[reader->topics()[message.topic].name];
    }
    EXPECT_EQ(reader->damage().count, 0U) << reader->damage().first;
    const YAML::Node info =
        YAML::LoadFile((folder() / "metadata.yaml").string())["rosbag2_bagfile_information"];
    EXPECT_EQ(info["message_count"].as<std::size_t>(), numbers.size());
    for (const YAML::Node& topic : info["topics_with_message_count"]) {
      EXPECT_EQ(topic["message_count"].as<int>(),
                by_topic[topic["topic_metadata"]["name"].as<std::string>()]);
    }
    std::size_t files = 0;
    for (const YAML::Node& file : info["files"]) {
      const auto alone = BagReader::open(folder() / file["path"].as<std::string>());
      int messages = 0;
      for (BagMessage message; alone->next(message);) ++messages;
      EXPECT_EQ(file["message_count"].as<int>(), messages) << file["path"];
      EXPECT_EQ(alone->damage().count, 0U);
      ++files;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder()), {}), files + 1) << "no other file";
    return numbers;
  }
  [[nodiscard]] static std::vector<int> all(int first, int last) {
    std::vector<int> numbers(static_cast<std::size_t>(last - first + 1));
    std::iota(numbers.begin(), numbers.end(), first);
    return numbers;
  }

 private:
  const test::TemporaryDirectory folder_;

 protected:
  BagWriter bag_{folder(), GetParam().options};
};

TEST_P(BagOnAFullDisk, GoesOnInAnotherFileWhenThereIsRoomAgain) {
  write_some(1, 5);
  bag_.flush();
  write_some(6, 10);
  {
    const test::FullDisk full;
    EXPECT_THROW(bag_.flush(), OutputError);
    EXPECT_THROW(bag_.flush(), OutputError);
    EXPECT_THROW(write(99, kHuge), OutputError) << "there is no place for it";
    write_some(11, 12);  // they wait
    EXPECT_EQ(bag_.gap().lost, 1U);
    EXPECT_TRUE(bag_.gap().lasts);
  }
  bag_.flush();
  EXPECT_FALSE(bag_.gap().lasts);
  write_some(13, 20);
  bag_.close();
  EXPECT_EQ(content(), all(1, 20));
  EXPECT_EQ(bag_.gap().lost, 1U);
}

TEST_P(BagOnAFullDisk, LosesNothingWhereAFileEndsInTheMiddleOfWhatIsWritten) {
  write_some(1, 5);
  bag_.flush();
  for (std::uint8_t i = 6; i <= 10; ++i) write(i, 50'000);
  std::uintmax_t largest = 0;
  for (const auto& entry : fs::directory_iterator(folder())) {
    largest = std::max(largest, entry.file_size());
  }
  {
    const test::FullDisk full(largest + 100);
    EXPECT_THROW(bag_.flush(), OutputError);
  }
  write_some(11, 15);
  bag_.close();
  EXPECT_EQ(content(), all(1, 15));
  EXPECT_EQ(bag_.gap().lost, 0U);
}

TEST_P(BagOnAFullDisk, KeepsTopicsThatComeMeanwhile) {
  write(1);
  std::size_t second = 0;
  {
    const test::FullDisk full;
    EXPECT_THROW(bag_.flush(), OutputError);
    try {
      second = bag_.add_topic({"/second", "std_msgs/msg/String"});
    } catch (const OutputError&) {
      second = bag_.add_topic({"/second", "std_msgs/msg/String"});
    }
    write(2, kSmall, second);
  }
  write(3, kSmall, second);
  bag_.close();
  EXPECT_EQ(content(), all(1, 3));
}

TEST_P(BagOnAFullDisk, CanBeClosedWhenThereIsRoomAgain) {
  write_some(1, 5);
  {
    const test::FullDisk full;
    EXPECT_THROW(bag_.close(), OutputError);
  }
  bag_.close();
  EXPECT_EQ(content(), all(1, 5));
  write(6);
  bag_.close();
  EXPECT_EQ(content(), all(1, 6));
}

TEST_P(BagOnAFullDisk, IsFullAgainAndAgain) {
  std::uint8_t number = 0;
  for (int round = 0; round < 4; ++round) {
    write(++number);
    {
      const test::FullDisk full;
      EXPECT_THROW(bag_.flush(), OutputError);
      write(++number);
    }
    write(++number);
    bag_.flush();
  }
  bag_.close();
  EXPECT_EQ(content(), all(1, number));
}

INSTANTIATE_TEST_SUITE_P(
    All, BagOnAFullDisk,
    ::testing::Values(
        Format{"Sqlite3", {.storage = BagStorage::kSqlite3}},
        Format{"Sqlite3SchemaFour", {.storage = BagStorage::kSqlite3, .sqlite_schema = 4}},
        Format{"Mcap", {.storage = BagStorage::kMcap}},
        Format{"McapZstd", {.storage = BagStorage::kMcap, .chunks = BagCompression::kZstd}}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::log
