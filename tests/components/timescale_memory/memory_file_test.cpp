// SPDX-License-Identifier: Apache-2.0
#include "components/timescale_memory/memory_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/memory/nodes/room_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::timescale_memory {
namespace {

using memory::test_world::observe;

class MemoryFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return (directory_.path() / "strata.db").string(); }

 private:
  test::TemporaryDirectory directory_;
};

void take_in(memory::TimescaleMemory& memory, int from, int to) {
  for (int t = from; t < to; ++t) {
    memory.observe(observe({0.02 * t, 0.2, 0.0}, static_cast<double>(t), t > 20));
  }
}

TEST_F(MemoryFileTest, GoesOnWhereItStoppedAsIfNothingHadHappened) {
  memory::TimescaleMemory uninterrupted({}, 3);
  take_in(uninterrupted, 0, 60);
  for (int part = 0; part < 3; ++part) {
    MemoryFile file(path(), 0.0, 100);
    memory::TimescaleMemory memory = file.resume({}, 3);
    take_in(memory, 20 * part, 20 * (part + 1));
    file.save(memory, true);
  }
  EXPECT_EQ(MemoryFile(path(), 0.0, 100).resume({}, 3).state(), uninterrupted.state());
}

TEST_F(MemoryFileTest, RefusesAMemoryMadeWithOtherSettings) {
  {
    MemoryFile file(path(), 0.0, 100);
    memory::TimescaleMemory memory = file.resume({}, 1);
    take_in(memory, 0, 3);
    file.save(memory, true);
  }
  memory::TimescaleConfig other;
  other.max_range_m = 6.0;
  MemoryFile file(path(), 0.0, 100);
  try {
    static_cast<void>(file.resume(other, 1));
    FAIL() << "took a memory of 8 m for one of 6 m";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("other settings"));
  }
}

TEST_F(MemoryFileTest, KeepsNoMoreNodesInRamThanItIsTold) {
  memory::TimescaleMemory unbounded({}, 3);
  take_in(unbounded, 0, 120);
  ASSERT_GT(unbounded.nodes().size(), 2U);
  for (int part = 0; part < 2; ++part) {
    MemoryFile file(path(), 0.0, 1);
    memory::TimescaleMemory memory = file.resume({}, 3);
    EXPECT_EQ(memory.resident(), 0U);
    for (int t = 60 * part; t < 60 * (part + 1); ++t) {
      take_in(memory, t, t + 1);
      file.save(memory, true);
      EXPECT_EQ(memory.resident(), 1U);
    }
  }
  EXPECT_EQ(MemoryFile(path(), 0.0, 1).resume({}, 3).state(), unbounded.state());
}

TEST_F(MemoryFileTest, WaitsForItsPeriodUnlessForced) {
  MemoryFile file(path(), 1000.0, 100);
  memory::TimescaleMemory memory = file.resume({}, 1);
  take_in(memory, 0, 3);
  file.save(memory, false);
  EXPECT_FALSE(memory::Store(path()).has_timescale());
  file.save(memory, true);
  EXPECT_EQ(memory::Store(path()).load_timescale().state(), memory.state());
}

}  // namespace
}  // namespace strata::timescale_memory
