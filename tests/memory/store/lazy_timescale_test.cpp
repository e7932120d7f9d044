// SPDX-License-Identifier: Apache-2.0
/// A building of ten thousand nodes: nobody waits for those he does not need.
#include <cstring>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/damage.hpp"
#include "memory/store/store.hpp"
#include "tests/memory/nodes/room_world.hpp"
#include "tests/memory/store/execute_sql.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

constexpr std::size_t kNodes = 10'000;
constexpr int kColumns = 100;
constexpr double kSpacing_m = 20.0;

TimescaleConfig tiny_config() {
  TimescaleConfig config;
  config.angle_bins = 8;
  config.levels = {{"short", 5, 3.1}, {"mid", 20, 27.0}};
  return config;
}

Eigen::Vector2d place_of(std::size_t node) {
  return {kSpacing_m * static_cast<double>(node % kColumns),
          kSpacing_m * static_cast<double>(node / kColumns)};
}

/// The room's scan, as if the room were around that node.
PosedScan scan_at(std::size_t node, int k) {
  PosedScan scan = observe({0.1, 0.0, 0.02 * k}, 10.0 * k, k % 2 == 0);
  scan.map_from_robot.x += place_of(node).x();
  scan.map_from_robot.y += place_of(node).y();
  return scan;
}

/// The same node ten thousand times, each at its own place.
TimescaleMemory large_building() {
  TimescaleMemory one(tiny_config());
  for (int k = 0; k < 30; ++k) one.observe(scan_at(0, k));
  std::vector<std::byte> head = one.head_state();
  const std::uint64_t nodes = kNodes;
  std::memcpy(head.data() + head.size() - sizeof nodes, &nodes, sizeof nodes);
  std::vector<TimescaleMemory::NodeState> states(kNodes, one.node_state(0));
  for (std::size_t n = 0; n < kNodes; ++n) {
    const Eigen::Vector2d place = place_of(n);
    std::memcpy(states[n].head.data(), place.data(), 2 * sizeof(double));
  }
  return TimescaleMemory::restore(head, states, "large building");
}

class LargeBuilding : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new test::TemporaryDirectory;
    memory_ = new TimescaleMemory(large_building());
    Store(path()).save_timescale(*memory_);
  }
  static void TearDownTestSuite() {
    delete memory_;
    delete directory_;
  }
  [[nodiscard]] static std::filesystem::path path() { return directory_->path() / "strata.db"; }
  [[nodiscard]] static const TimescaleMemory& memory() { return *memory_; }
  /// A copy of the file that a test may spoil.
  [[nodiscard]] static std::filesystem::path copy(const char* name) {
    std::filesystem::copy_file(path(), directory_->path() / name);
    return directory_->path() / name;
  }

 private:
  inline static test::TemporaryDirectory* directory_ = nullptr;
  inline static TimescaleMemory* memory_ = nullptr;
};

TEST_F(LargeBuilding, OpensWithoutReadingItsNodes) {
  const Store store(path(), {.read_only = true, .check = false});
  const TimescaleMemory opened = store.open_timescale();
  EXPECT_EQ(opened.nodes().size(), kNodes);
  EXPECT_EQ(opened.resident(), 0U);
  EXPECT_EQ(opened.observations(), memory().observations());
  EXPECT_EQ(opened.head_state(), memory().head_state());
}

TEST_F(LargeBuilding, IsTheSameAsWhenReadAtOnce) {
  const Store store(path(), {.read_only = true, .check = false});
  EXPECT_EQ(store.open_timescale().state(), store.load_timescale().state());
}

TEST_F(LargeBuilding, WakesTheNodesThatScansAreForAndSavesThoseOnly) {
  const auto file = copy("walk.db");
  TimescaleMemory truth = memory();
  {
    Store store(file, {.check = false});
    TimescaleMemory opened = store.open_timescale();
    SavedTimescale saved = Store::all_saved(opened);
    for (std::size_t n = 0; n < 50; ++n) {
      const std::size_t node = 37 * n;
      ASSERT_EQ(opened.observe(scan_at(node, 100)).node, static_cast<int>(node));
      truth.observe(scan_at(node, 100));
      EXPECT_EQ(store.save_timescale_changes(opened, saved), 1U);
      opened.evict(10, store.timescale_nodes());
      EXPECT_LE(opened.resident(), 10U);
    }
    // Back to nodes that were evicted since.
    for (std::size_t n = 0; n < 50; ++n) {
      opened.observe(scan_at(37 * n, 200));
      truth.observe(scan_at(37 * n, 200));
    }
    EXPECT_EQ(store.save_timescale_changes(opened, saved), 50U);
    EXPECT_EQ(store.save_timescale_changes(opened, saved), 0U);
    EXPECT_EQ(opened.state(), truth.state());
  }
  EXPECT_EQ(Store(file, {.check = false}).load_timescale().state(), truth.state());
}

TEST_F(LargeBuilding, OutlivesTheStoreItWasOpenedFrom) {
  std::optional<TimescaleMemory> opened;
  {
    const Store store(path(), {.read_only = true, .check = false});
    opened = store.open_timescale();
  }
  EXPECT_EQ(opened->observe(scan_at(7, 100)).node, 7);
  EXPECT_EQ(opened->resident(), 1U);
}

TEST_F(LargeBuilding, IsSavedAsAWholeThoughItsNodesAreEvictedToTheSameStore) {
  Store store(copy("whole.db"), {.check = false});
  TimescaleMemory opened = store.open_timescale();
  opened.observe(scan_at(7, 100));
  const std::vector<std::byte> before = opened.state();
  store.save_timescale(opened);
  EXPECT_EQ(store.load_timescale().state(), before);
  store.save_timescale(opened, "a copy");
  EXPECT_EQ(store.load_timescale("a copy").state(), before);
  // Of what was larger nothing is left.
  TimescaleMemory small(tiny_config());
  for (int k = 0; k < 30; ++k) small.observe(scan_at(0, k));
  store.save_timescale(small);
  EXPECT_EQ(store.load_timescale().state(), small.state());
}

TEST_F(LargeBuilding, WithOneDamagedNodeWorksEverywhereElseAndSaysWhatIsWrong) {
  const auto file = copy("damaged.db");
  test::execute(file,
                "UPDATE timescale_level SET data = substr(data, 1, length(data) - 1) || x'5a' "
                "WHERE node = 42 AND level = 1");
  const Store store(file, {.check = false});
  TimescaleMemory opened = store.open_timescale();
  EXPECT_EQ(opened.observe(scan_at(41, 100)).node, 41);
  try {
    opened.observe(scan_at(42, 100));
    FAIL() << "took a damaged node";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("damaged"));
    EXPECT_THAT(error.what(), testing::HasSubstr("damaged.db"));
    EXPECT_FALSE(error.remedy().empty());
  }
  EXPECT_EQ(opened.observe(scan_at(43, 100)).node, 43);
}

/// Nodes 42 and 4711 cannot be read.
class DamagedBuilding : public LargeBuilding {
 protected:
  /// name: of the file, one a test.
  [[nodiscard]] static TimescaleMemory opened(const char* name) {
    const auto file = copy(name);
    test::execute(file,
                  "UPDATE timescale_level SET data = substr(data, 1, length(data) - 1) || x'5a' "
                  "WHERE node IN (42, 4711) AND level = 1");
    return Store(file, {.check = false}).open_timescale();
  }
  static std::vector<std::size_t> pending(const NodeMap& map) {
    std::vector<std::size_t> result;
    for (std::size_t n = 0; n < map.nodes().size(); ++n) {
      if (map.nodes()[n].is_pending) result.push_back(n);
    }
    return result;
  }
};

TEST_F(DamagedBuilding, IsDecodedButForItsDamagedNodesWhichAreNamedOnce) {
  TimescaleMemory memory = opened("decoded.db");
  EXPECT_THROW((void)memory.decode(), DamageError);
  std::vector<DamagedNode> damaged;
  auto map = memory.decode({}, nullptr, 0.0, kNodes, &damaged);
  EXPECT_THAT(pending(*map), testing::ElementsAre(42U, 4711U));
  ASSERT_EQ(damaged.size(), 2U);
  EXPECT_EQ(damaged[0].node, 42U);
  EXPECT_THAT(damaged[0].error.what(), testing::HasSubstr("node 42 at (840.0, 0.0) m"));
  for (const DamagedNode& found : damaged) memory.pass_over(found.node);
  map = memory.decode({}, map.get(), 0.0, kNodes, &damaged);
  EXPECT_THAT(pending(*map), testing::ElementsAre(42U, 4711U));
  EXPECT_EQ(damaged.size(), 2U);
}

TEST_F(DamagedBuilding, LearnsThePlaceOfADamagedNodeAnew) {
  TimescaleMemory memory = opened("anew.db");
  EXPECT_THROW((void)memory.observe(scan_at(42, 100)), DamageError);
  const Observed observed = memory.observe(scan_at(42, 101));
  EXPECT_TRUE(observed.is_new_node);
  EXPECT_EQ(memory.observe(scan_at(42, 102)).node, observed.node);
  EXPECT_EQ(memory.nodes().size(), kNodes + 1);
}

}  // namespace
}  // namespace strata::memory
