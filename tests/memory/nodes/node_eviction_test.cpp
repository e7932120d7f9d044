// SPDX-License-Identifier: Apache-2.0
/// Nodes that are not in memory must not be missed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

TimescaleConfig small_config() {
  TimescaleConfig config;
  config.angle_bins = 60;
  config.levels = {{"short", 5, 3.1}, {"mid", 20, 27.0}, {"daily", 10, 27.0, 3.0}};
  return config;
}

/// All nodes of a memory as they were at one moment.
class Snapshot final : public NodeSource {
 public:
  explicit Snapshot(const TimescaleMemory& memory) {
    for (std::size_t n = 0; n < memory.nodes().size(); ++n) {
      states_.push_back(memory.node_state(n));
    }
  }
  [[nodiscard]] std::vector<std::vector<std::byte>> levels_of(std::size_t node) const override {
    ++reads;
    return states_.at(node).levels;
  }
  [[nodiscard]] std::string place() const override { return "snapshot"; }
  [[nodiscard]] std::vector<std::vector<std::byte>> heads() const {
    std::vector<std::vector<std::byte>> result;
    for (const auto& state : states_) result.push_back(state.head);
    return result;
  }
  mutable int reads = 0;

 private:
  std::vector<TimescaleMemory::NodeState> states_;
};

PosedScan scan_of(int k) {
  return observe({-0.5 + 3.0 * std::sin(0.05 * k), 0.3 + 1.5 * std::cos(0.03 * k), 0.05 * k},
                 3000.0 * k, k % 20 < 10);  // a day every 29 scans
}

TimescaleMemory after(int scans) {
  TimescaleMemory memory(small_config(), 7);
  for (int k = 0; k < scans; ++k) memory.observe(scan_of(k));
  return memory;
}

TimescaleMemory evict_all(const TimescaleMemory& memory) {
  const auto source = std::make_shared<const Snapshot>(memory);
  return TimescaleMemory::restore_evicted(memory.head_state(), source->heads(), source);
}

std::vector<bool> evicted_nodes(const TimescaleMemory& memory) {
  std::vector<bool> evicted;
  for (const MemoryNode& node : memory.nodes()) evicted.push_back(node.is_evicted());
  return evicted;
}

TEST(SleepingNodes, OfAMemoryThatWasRestoredAreThoseThatWereNeededLongestAgo) {
  TimescaleMemory memory = after(150);
  ASSERT_GT(memory.nodes().size(), 3U);
  std::vector<TimescaleMemory::NodeState> nodes;
  for (std::size_t n = 0; n < memory.nodes().size(); ++n) nodes.push_back(memory.node_state(n));
  TimescaleMemory restored = TimescaleMemory::restore(memory.head_state(), nodes, "test");
  const auto source = std::make_shared<const Snapshot>(memory);
  for (std::size_t resident = memory.nodes().size() - 1; resident > 0; --resident) {
    memory.evict(resident, source);
    restored.evict(resident, source);
    EXPECT_EQ(evicted_nodes(restored), evicted_nodes(memory)) << resident;
  }
}

TEST(SleepingNodes, AreReadFirstWhereTheRobotWasLastThoughTheMemoryWasRestored) {
  const TimescaleMemory memory = after(150);
  const TimescaleMemory restored = evict_all(memory);
  TimescaleMemory evicted = memory;
  evicted.evict(0, std::make_shared<const Snapshot>(memory));
  const auto of_restored = restored.decode({}, nullptr, 0.0, 1);
  const auto of_evicted = evicted.decode({}, nullptr, 0.0, 1);
  for (std::size_t n = 0; n < memory.nodes().size(); ++n) {
    EXPECT_EQ(of_restored->nodes()[n].is_pending, of_evicted->nodes()[n].is_pending) << n;
  }
}

TEST(SleepingNodes, OfAMemoryThatWasRestoredHaveSettledWhenItsNewestScanSaysSo) {
  constexpr double kScan_s = 3000.0;
  const TimescaleMemory memory = after(150);
  std::vector<TimescaleMemory::NodeState> nodes;
  for (std::size_t n = 0; n < memory.nodes().size(); ++n) nodes.push_back(memory.node_state(n));
  const TimescaleMemory restored = TimescaleMemory::restore(memory.head_state(), nodes, "test");
  int unsettled = 0;
  for (const double unsettled_s : {1.5 * kScan_s, 20.0 * kScan_s}) {
    const auto truth = memory.decode({}, nullptr, unsettled_s);
    const auto map = restored.decode({}, nullptr, unsettled_s);
    for (std::size_t n = 0; n < memory.nodes().size(); ++n) {
      EXPECT_EQ(map->nodes()[n].levels[0]->insertions, truth->nodes()[n].levels[0]->insertions);
      unsettled += truth->nodes()[n].levels[0]->insertions == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(unsettled, 0) << "else it says nothing of the newest scan";
}

void expect_same(const NodeMap& map, const NodeMap& truth) {
  ASSERT_EQ(map.nodes().size(), truth.nodes().size());
  for (std::size_t n = 0; n < truth.nodes().size(); ++n) {
    EXPECT_FALSE(map.nodes()[n].is_pending);
    for (std::size_t l = 0; l < truth.nodes()[n].levels.size(); ++l) {
      EXPECT_EQ(map.nodes()[n].levels[l]->insertions, truth.nodes()[n].levels[l]->insertions);
      EXPECT_THAT(map.nodes()[n].levels[l]->scan.range_m,
                  testing::Pointwise(testing::NanSensitiveFloatEq(),
                                     truth.nodes()[n].levels[l]->scan.range_m));
    }
  }
}

TEST(SleepingNodes, LearnAsIfTheyHadNeverSlept) {
  const int scans = 200;
  TimescaleMemory memory(small_config(), 7);
  for (int k = 0; k < scans; ++k) {
    memory.observe(scan_of(k));
    if (k % 7 == 0) memory.evict(2, std::make_shared<const Snapshot>(memory));
  }
  const TimescaleMemory truth = after(scans);
  ASSERT_GT(truth.nodes().size(), 6U);
  EXPECT_LT(memory.resident(), truth.nodes().size());
  EXPECT_EQ(memory.state(), truth.state());
}

TEST(SleepingNodes, EndTheirDayToo) {
  TimescaleMemory truth = after(100);
  TimescaleMemory memory = evict_all(truth);
  truth.close_day();
  memory.close_day();
  EXPECT_EQ(memory.state(), truth.state());
}

TEST(SleepingNodes, AreTheOnesNeededLongestAgo) {
  TimescaleMemory memory = after(150);
  const int last = memory.observe(scan_of(150)).node;
  ASSERT_GE(last, 0);
  memory.evict(1, std::make_shared<const Snapshot>(memory));
  EXPECT_EQ(memory.resident(), 1U);
  EXPECT_FALSE(memory.nodes()[static_cast<std::size_t>(last)].is_evicted());
}

TEST(SleepingNodes, AreDecodedWithoutWaking) {
  const TimescaleMemory truth = after(150);
  const TimescaleMemory memory = evict_all(truth);
  const auto map = memory.decode();
  expect_same(*map, *truth.decode());
  EXPECT_EQ(memory.resident(), 0U);
}

TEST(SleepingNodes, AreReadOnceForManySnapshots) {
  const TimescaleMemory truth = after(150);
  const auto source = std::make_shared<const Snapshot>(truth);
  TimescaleMemory memory =
      TimescaleMemory::restore_evicted(truth.head_state(), source->heads(), source);
  auto map = memory.decode();
  EXPECT_EQ(source->reads, static_cast<int>(truth.nodes().size()));
  map = memory.decode({}, map.get());
  EXPECT_EQ(source->reads, static_cast<int>(truth.nodes().size()));
}

TEST(SleepingNodes, ComeAFewASnapshotTheNearestFirst) {
  const TimescaleMemory truth = after(150);
  TimescaleMemory memory = evict_all(truth);
  const int here = memory.observe(scan_of(150)).node;
  ASSERT_GE(here, 0);
  std::shared_ptr<const NodeMap> map;
  double before_m = 0.0;
  for (std::size_t ready = 1; ready <= truth.nodes().size(); ++ready) {
    map = memory.decode({}, map.get(), 0.0, ready == 1 ? 0 : 1);
    double furthest_m = 0.0;
    std::size_t pending = 0;
    for (std::size_t n = 0; n < map->nodes().size(); ++n) {
      const auto& node = map->nodes()[n];
      pending += node.is_pending ? 1 : 0;
      const auto& from = memory.nodes()[static_cast<std::size_t>(here)].position_m;
      if (!node.is_pending) furthest_m = std::max(furthest_m, (node.position_m - from).norm());
    }
    EXPECT_EQ(pending, truth.nodes().size() - ready);
    EXPECT_GE(furthest_m, before_m);
    before_m = furthest_m;
  }
  TimescaleMemory resident = after(150);
  resident.observe(scan_of(150));
  expect_same(*map, *resident.decode());
  // What is expected at a place is the same too, by whichever way the snapshot came about.
  for (int i = 0; i < 100; ++i) {
    const Pose2 laser{-2.0 + 0.05 * i, 0.5, 0.1 * i};
    const float expected = map->expected_range_m(0, laser, 0.3);
    EXPECT_THAT(expected,
                testing::NanSensitiveFloatEq(resident.decode()->expected_range_m(0, laser, 0.3)));
  }
}

TEST(SleepingNodes, ThatLearnedSinceTheLastSnapshotAreDecodedAnew) {
  TimescaleMemory memory = after(100);
  memory.evict(0, std::make_shared<const Snapshot>(memory));
  const auto before = memory.decode();
  for (int k = 100; k < 140; ++k) memory.observe(scan_of(k));
  memory.evict(0, std::make_shared<const Snapshot>(memory));
  EXPECT_EQ(memory.resident(), 0U);
  expect_same(*memory.decode({}, before.get()), *after(140).decode());
}

TEST(SleepingNodes, ThatCannotBeReadAreToldOf) {
  const TimescaleMemory truth = after(100);
  auto states = std::make_shared<Snapshot>(truth);
  auto heads = states->heads();
  TimescaleMemory memory = TimescaleMemory::restore_evicted(
      truth.head_state(), heads, std::make_shared<const Snapshot>(TimescaleMemory(small_config())));
  EXPECT_THROW(memory.observe(scan_of(100)), std::exception);
  heads.pop_back();
  EXPECT_THROW((void)TimescaleMemory::restore_evicted(truth.head_state(), heads, states),
               InputError);
}

}  // namespace
}  // namespace strata::memory
