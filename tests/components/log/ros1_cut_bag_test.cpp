// SPDX-License-Identifier: Apache-2.0
/// ROS 1 bags that end anywhere: what is read is how the whole bag begins, and that it ends is
/// said.
#include <algorithm>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/byte_cursor.hpp"
#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using test_log::BagContent;
using test_log::Ros1End;
using ::testing::HasSubstr;

/// Where the records of a bag begin, those in its chunks left out.
std::set<std::size_t> record_starts(const std::string& bag) {
  std::set<std::size_t> starts;
  const auto length_at = [&](std::size_t at) {
    return ByteCursor(View(reinterpret_cast<const std::uint8_t*>(bag.data()) + at, 4))
        .number<std::uint32_t>();
  };
  for (std::size_t at = 13; at + 8 < bag.size();) {
    starts.insert(at);
    at += 4 + length_at(at);
    // The lengths of a chunk that is not finished are zero, so what is packed in it follows.
    if (at + 4 > bag.size()) break;
    at += 4 + length_at(at);
  }
  return starts;
}

class Ros1CutBag : public ::testing::TestWithParam<std::tuple<const char*, Ros1End>> {
 protected:
  void SetUp() override {
    const auto& [compression, end] = GetParam();
    write_bag(folder_.path() / "ros2", test_log::make_log(12, 9, 5), BagStorage::kSqlite3);
    bag_ = test_log::ros1_bag_of(folder_.path() / "ros2",
                                 {.compression = compression, .chunk_bytes = 4000, .end = end});
    whole_ = read(bag_.size());
    ASSERT_EQ(whole_.messages.size(), 61U);
  }
  BagContent read(std::size_t size) {
    const fs::path file = folder_.path() / "cut.bag";
    test_log::write_text(file, bag_.substr(0, size));
    return test_log::read_bag(file);
  }
  /// How many messages the bag has when it is cut there.
  std::size_t check(std::size_t size) {
    BagContent cut;
    try {
      cut = read(size);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("cut.bag")) << size;
      EXPECT_THAT(error.what(), HasSubstr("byte ")) << size;
      EXPECT_FALSE(error.remedy().empty());
      return 0;
    }
    EXPECT_LE(cut.messages.size(), whole_.messages.size());
    EXPECT_TRUE(std::equal(cut.messages.begin(), cut.messages.end(), whole_.messages.begin()))
        << "cut at " << size;
    EXPECT_GE(cut.damage.count, 1U) << "cut at " << size;
    EXPECT_THAT(cut.damage.first, HasSubstr("cut.bag: byte ")) << "cut at " << size;
    return cut.messages.size();
  }
  strata::test::TemporaryDirectory folder_;
  std::string bag_;
  BagContent whole_;
};

TEST_P(Ros1CutBag, IsReadUpToAnyRecord) {
  const Ros1End end = std::get<1>(GetParam());
  std::size_t before = 0;
  for (const std::size_t start : record_starts(bag_)) {
    for (const std::size_t size : {start - 1, start, start + 1}) {
      const std::size_t messages = check(size);
      EXPECT_GE(messages, before) << "cut at " << size;
      before = messages;
    }
  }
  // Only the index is missing then.
  if (end == Ros1End::kWhole) {
    EXPECT_EQ(before, whole_.messages.size());
  }
}

TEST_P(Ros1CutBag, IsReadUpToAnyByte) {
  std::mt19937_64 random(7);
  std::set<std::size_t> sizes;
  while (sizes.size() < 150) sizes.insert(14 + random() % (bag_.size() - 14));
  std::size_t before = 0;
  for (const std::size_t size : sizes) {
    const std::size_t messages = check(size);
    EXPECT_GE(messages, before) << "cut at " << size;
    before = messages;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Ros1CutBag,
                         ::testing::Combine(::testing::Values("none", "bz2", "lz4"),
                                            ::testing::Values(Ros1End::kWhole, Ros1End::kNoIndex,
                                                              Ros1End::kUnfinishedChunk)));

}  // namespace
}  // namespace strata::log
