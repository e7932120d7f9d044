// SPDX-License-Identifier: Apache-2.0
/// What bags have that robots and simulators of ROS 1 recorded, and the format does not tell.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/log_writer.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using ::testing::HasSubstr;

class RecordedRos1Bag : public ::testing::Test {
 protected:
  fs::path write(const std::string& bytes) {
    test::write_text(folder_.path() / "drive.bag", bytes);
    return folder_.path() / "drive.bag";
  }
  strata::test::TemporaryDirectory folder_;
};

TEST_F(RecordedRos1Bag, WhoseIndexStatesMoreThanItHasLosesNoChunk) {
  write_bag(folder_.path() / "ros2", test::make_log(60, 180, 7), BagStorage::kSqlite3);
  const auto whole = test::read_bag(write(test::ros1_bag_of(folder_.path() / "ros2")));
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const auto bag = test::read_bag(write(test::ros1_bag_of(
        folder_.path() / "ros2", {.compression = compression, .stated_entry_bytes = 20})));
    EXPECT_EQ(bag.damage.count, 0U) << bag.damage.first;
    EXPECT_EQ(bag.messages, whole.messages) << compression;
  }
}

TEST_F(RecordedRos1Bag, OfWhichAChunkStatesTooMuchLosesNoOther) {
  write_bag(folder_.path() / "ros2", test::make_log(60, 180, 7), BagStorage::kSqlite3);
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::string bytes =
        test::ros1_bag_of(folder_.path() / "ros2", {.compression = compression});
    const auto whole = test::read_bag(write(bytes));
    const std::size_t chunk = bytes.find("compression=", bytes.size() / 3) - 16;
    const std::size_t length = chunk + 4 + static_cast<unsigned char>(bytes[chunk]);
    for (const std::size_t place :
         {length + 1, length + 3}) {  // into what follows; out of the file
      std::string spoilt = bytes;
      spoilt[place] = '\x7F';
      const auto bag = test::read_bag(write(spoilt));
      EXPECT_EQ(bag.damage.count, 1U);
      EXPECT_THAT(bag.damage.first, HasSubstr("byte " + std::to_string(chunk)));
      EXPECT_EQ(bag.messages, whole.messages) << compression;
    }
  }
}

}  // namespace
}  // namespace strata::log
