// SPDX-License-Identifier: Apache-2.0
/// Stores that older versions wrote must always open. `examples/` keeps one of each.
#include <gtest/gtest.h>

#include "memory/store/detail/schema.hpp"
#include "memory/store/store.hpp"
#include "memory/store/store_summary.hpp"
#include "tests/memory/nodes/room_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

/// A copy that may be changed.
class OldStore : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path copy_of(const std::string& example) const {
    const auto path = directory_.path() / "strata.db";
    std::filesystem::copy_file(std::filesystem::path(STRATA_STORE_EXAMPLES) / example, path);
    return path;
  }

 private:
  test::TemporaryDirectory directory_;
};

/// What the first version saved of four seconds in a room.
void expect_version_1(const Store& store) {
  const TimescaleMemory memory = store.load_timescale();
  EXPECT_EQ(memory.nodes().size(), 3U);
  EXPECT_EQ(memory.observations(), 7U);
  EXPECT_EQ(memory.config().angle_bins, 36);
  EXPECT_EQ(memory.config().node_spacing_m, 1.5);
  ASSERT_EQ(memory.config().levels.size(), 2U);
  EXPECT_EQ(memory.config().levels[0].name, "short");
  EXPECT_EQ(memory.nodes()[1].levels[1].sample_count(), 19U);
  EXPECT_EQ(memory.nodes()[1].levels[1].pair_count(), 16U);
  EXPECT_EQ(store.load_reflection_grid("occupancy").rect().width(), 122);
  ASSERT_EQ(store.load_trajectory(0).size(), 21U);
  EXPECT_NEAR(store.load_trajectory(0).back().map_from_robot.x, 3.215019770691844, 1e-12);
  EXPECT_TRUE(store.load_scans(0).empty());
}

TEST_F(OldStore, OfVersion1OpensForReadingAsItIs) {
  const auto path = copy_of("version_1.db");
  expect_version_1(Store(path, {.read_only = true}));
  EXPECT_EQ(summarize_store(path).version, 1);
}

TEST_F(OldStore, OfVersion1IsUpgradedAndGoesOn) {
  const auto path = copy_of("version_1.db");
  {
    Store store(path);
    expect_version_1(store);
    TimescaleMemory memory = store.load_timescale();
    SavedTimescale saved = Store::all_saved(memory);
    const auto& node = memory.nodes()[0];
    PosedScan scan =
        test_world::observe({node.position_m.x(), node.position_m.y(), 0.0}, 1e6, false);
    EXPECT_EQ(memory.observe(scan).outcome, ObserveOutcome::kTaken);
    EXPECT_EQ(store.save_timescale_changes(memory, saved), 1U);
  }
  EXPECT_EQ(summarize_store(path).version, detail::kSchemaVersion);
  EXPECT_EQ(Store(path).load_timescale().observations(), 8U);
}

TEST(StoreSummary, TellsAStoreThatIsBeingWritten) {
  const test::TemporaryDirectory folder;
  const auto path = folder.path() / "strata.db";
  Store store(path);
  store.save_text("note", "of now");
  EXPECT_TRUE(is_store(path));
  EXPECT_EQ(summarize_store(path).texts, std::vector<std::string>{"note"});
}

TEST_F(OldStore, IsSummarizedWithoutBeingLoaded) {
  const auto path = copy_of("version_1.db");
  EXPECT_TRUE(is_store(path));
  EXPECT_FALSE(is_store(path.parent_path() / "missing.db"));
  const StoreSummary summary = summarize_store(path);
  ASSERT_EQ(summary.timescales.size(), 1U);
  EXPECT_EQ(summary.timescales[0].nodes, 3);
  ASSERT_EQ(summary.timescales[0].levels.size(), 2U);
  const StoreSummary::Level& mid = summary.timescales[0].levels[1];
  EXPECT_EQ(mid.name, "mid");
  EXPECT_EQ(mid.half_life_s, 20.0);
  EXPECT_EQ(mid.samples, 19 + 19 + 7);
  EXPECT_EQ(mid.max_bytes_a_node, 144);
  ASSERT_EQ(summary.runs.size(), 1U);
  EXPECT_EQ(summary.runs[0].poses, 21);
  ASSERT_FALSE(summary.grids.empty());
  EXPECT_EQ(summary.grids[0].name, "occupancy");
  EXPECT_NEAR(summary.grids[0].width_m, 6.1, 1e-9);
}

}  // namespace
}  // namespace strata::memory
