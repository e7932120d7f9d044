// SPDX-License-Identifier: Apache-2.0
/// Memory that runs out within SQLite is told as that, and not as a file that cannot be used.
#include <cstdint>
#include <new>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "components/log/bag.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

/// SQLite of this process gets no more than so many bytes beside what it has.
class LittleMemory {
 public:
  explicit LittleMemory(std::int64_t more) {
    sqlite3_hard_heap_limit64(sqlite3_memory_used() + more);
  }
  ~LittleMemory() { sqlite3_hard_heap_limit64(0); }
  LittleMemory(const LittleMemory&) = delete;
  LittleMemory& operator=(const LittleMemory&) = delete;
};

constexpr std::int64_t kSome = 300'000;

class BagWithoutMemory : public ::testing::Test {
 protected:
  void write_one(BagWriter& bag) {
    bag.write(bag.add_topic({"/topic", "std_msgs/msg/String"}), Stamp{1},
              std::vector<std::uint8_t>(3'000'000, 7));
    bag.flush();
  }
  test::TemporaryDirectory folder_;
  const std::filesystem::path bag_ = folder_.path() / "bag";
};

TEST_F(BagWithoutMemory, IsNotADiskThatCannotBeWritten) {
  BagWriter bag(bag_, BagStorage::kSqlite3);
  {
    const LittleMemory little(kSome);
    EXPECT_THROW(write_one(bag), std::bad_alloc);
  }
  bag.close();
  const auto reader = BagReader::open(bag_);
  BagMessage message;
  EXPECT_TRUE(reader->next(message)) << "what waited is written once there is memory";
}

TEST_F(BagWithoutMemory, IsNoDamage) {
  {
    BagWriter bag(bag_, BagStorage::kSqlite3);
    write_one(bag);
    bag.close();
  }
  const auto reader = BagReader::open(bag_);
  const LittleMemory little(kSome);
  BagMessage message;
  EXPECT_THROW((void)reader->next(message), std::bad_alloc);
  EXPECT_EQ(reader->damage().count, 0U);
}

}  // namespace
}  // namespace strata::log
