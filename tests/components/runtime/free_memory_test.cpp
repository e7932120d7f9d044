// SPDX-License-Identifier: Apache-2.0
/// That a process which freed much gives it back.
#include "components/runtime/free_memory.hpp"

#include <chrono>
#include <cstddef>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/runtime/host.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata::runtime {
namespace {

constexpr std::size_t kBlock_bytes = 50'000;  // below the size that glibc maps on its own
constexpr std::size_t kBlocks = 2'000;        // 100 MB
constexpr std::size_t kGarbage_bytes = kBlock_bytes * kBlocks;

using Block = std::vector<char>;

/// Allocates in the arena of a thread of its own and frees all but the last block, below which the
/// arena does not shrink by itself.
Block leave_garbage() {
  Block kept;
  std::thread([&kept] {
    std::vector<Block> blocks;
    for (std::size_t i = 0; i < kBlocks; ++i) blocks.emplace_back(kBlock_bytes, 'x');
    kept = std::move(blocks.back());
  }).join();
  return kept;
}

class Idle final : public Component {
 public:
  using Component::Component;

 private:
  void on_configure() override {}
};

#ifndef __SANITIZE_ADDRESS__  // whose allocator keeps what was freed
TEST(FreeMemory, OfAnArenaWhoseLastBlockIsInUseIsKeptUntilItIsReturned) {
  const std::size_t before = resident_bytes();
  ASSERT_GT(before, 0U);
  const Block kept = leave_garbage();
  const std::size_t held = resident_bytes();
  ASSERT_GT(held, before + kGarbage_bytes / 2);
  return_free_memory();
  EXPECT_LT(resident_bytes(), held - kGarbage_bytes / 2);
  EXPECT_EQ(kept.back(), 'x');
}

TEST(FreeMemory, GoesBackAtATickOfTheHost) {
  Registry registry;
  registry.add<Idle>("test::Idle");
  const auto host =
      test::make_host("{type: test::Idle, name: idle}", registry, test::make_participant());
  const Block kept = leave_garbage();
  const std::size_t held = resident_bytes();
  ASSERT_GT(held, kGarbage_bytes);
  host->tick();
  EXPECT_LT(resident_bytes(), held - kGarbage_bytes / 2);
  EXPECT_EQ(kept.back(), 'x');
}
#endif

TEST(FreeMemory, IsReturnedOnceAMinuteAndOnlyAfterGrowth) {
  FreeMemoryTurn turn;
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  const std::vector<char> held(2 * FreeMemoryTurn::kGrowth_bytes, 'x');
  EXPECT_TRUE(turn.take(start)) << "the first time";
  EXPECT_FALSE(turn.take(start + 2 * FreeMemoryTurn::kRest)) << "nothing has grown";
  const std::vector<char> grown(2 * FreeMemoryTurn::kGrowth_bytes, 'x');
  EXPECT_FALSE(turn.take(start + FreeMemoryTurn::kRest / 2)) << "too soon";
  EXPECT_TRUE(turn.take(start + FreeMemoryTurn::kRest));
  EXPECT_EQ(held.back(), grown.back());
}

}  // namespace
}  // namespace strata::runtime
