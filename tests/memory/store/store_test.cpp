// SPDX-License-Identifier: Apache-2.0
#include "memory/store/store.hpp"

#include <bit>
#include <cstdint>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

using strata::test::same_bits;

using test::TemporaryDirectory;

ReflectionGrid random_reflection(RandomStream& random, const CellRect& rect) {
  ReflectionGrid grid = make_reflection_grid(0.05, rect);
  for (float& value : grid.values()) {
    if (random.bernoulli(0.7)) value = static_cast<float>(random.uniform());
  }
  return grid;
}

Grid<CellCounts> random_counts(RandomStream& random, const CellRect& rect) {
  Grid<CellCounts> grid(0.05, rect);
  for (CellCounts& cell : grid.values()) {
    cell = {random.exponential(1.0), random.exponential(0.1)};
  }
  return grid;
}

patch::PatchMap random_patch_map(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  patch::PatchMap map;
  map.base = random_reflection(random, {{-20, -10}, {31, 47}});
  for (int s = 0; s < 3; ++s) {
    patch::Submap submap;
    submap.id = s;
    submap.rect = {{-5 + s, 2}, {9 + s, 11}};
    submap.contradictory = Grid<std::uint8_t>(0.05, submap.rect);
    for (auto& cell : submap.contradictory.values()) cell = random.bernoulli(0.2) ? 1 : 0;
    for (int c = 0; c <= s; ++c) {
      submap.configurations.push_back({random_counts(random, submap.rect),
                                       random_reflection(random, submap.rect), random.uniform()});
    }
    for (int q = 0; q < 4; ++q) {
      patch::SequenceInfo sequence{q % 2, {100'000'000'001LL * q}, {-5LL}, 10U, {}};
      for (int c = 0; c <= s; ++c) sequence.membership.push_back(random.uniform() / 3.0);
      submap.sequences.push_back(sequence);
    }
    submap.change_rate_per_s = random.uniform();
    map.submaps.push_back(submap);
  }
  map.entry_margin_m = 0.75;
  return map;
}

void expect_same(const patch::PatchMap& a, const patch::PatchMap& b) {
  EXPECT_TRUE(same_bits(a.base, b.base));
  EXPECT_EQ(a.entry_margin_m, b.entry_margin_m);
  ASSERT_EQ(a.submaps.size(), b.submaps.size());
  for (std::size_t s = 0; s < a.submaps.size(); ++s) {
    const patch::Submap& left = a.submaps[s];
    const patch::Submap& right = b.submaps[s];
    EXPECT_EQ(left.id, right.id);
    EXPECT_EQ(left.rect, right.rect);
    EXPECT_EQ(left.change_rate_per_s, right.change_rate_per_s);
    EXPECT_TRUE(same_bits(left.contradictory, right.contradictory));
    ASSERT_EQ(left.configurations.size(), right.configurations.size());
    for (std::size_t c = 0; c < left.configurations.size(); ++c) {
      EXPECT_TRUE(same_bits(left.configurations[c].counts, right.configurations[c].counts));
      EXPECT_TRUE(same_bits(left.configurations[c].reflection, right.configurations[c].reflection));
      EXPECT_EQ(left.configurations[c].prior, right.configurations[c].prior);
    }
    ASSERT_EQ(left.sequences.size(), right.sequences.size());
    for (std::size_t q = 0; q < left.sequences.size(); ++q) {
      EXPECT_EQ(left.sequences[q].run, right.sequences[q].run);
      EXPECT_EQ(left.sequences[q].begin, right.sequences[q].begin);
      EXPECT_EQ(left.sequences[q].end, right.sequences[q].end);
      EXPECT_EQ(left.sequences[q].scans, right.sequences[q].scans);
      EXPECT_EQ(left.sequences[q].membership, right.sequences[q].membership);
    }
  }
}

TEST(Store, GivesGridsBackBitForBit) {
  const TemporaryDirectory directory;
  RandomStream random(1, StreamId::kTest);
  const ReflectionGrid reflection = random_reflection(random, {{-7, 3}, {60, 41}});
  const Grid<CellCounts> counts = random_counts(random, {{-100, -100}, {-50, -80}});
  {
    Store store(directory.path() / "strata.db");
    store.save_grid("filtered", reflection);
    store.save_grid("raw", counts);
    store.save_grid("empty", make_reflection_grid(0.1, {}));
  }
  const Store store(directory.path() / "strata.db", {.read_only = true});
  EXPECT_THAT(store.grid_names(), testing::ElementsAre("empty", "filtered", "raw"));
  EXPECT_TRUE(same_bits(store.load_reflection_grid("filtered"), reflection));
  EXPECT_TRUE(same_bits(store.load_counts_grid("raw"), counts));
  EXPECT_EQ(store.load_reflection_grid("empty").size(), 0U);
}

TEST(Store, ReplacesAGridOfTheSameName) {
  const TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  store.save_grid("map", ReflectionGrid(0.05, {{0, 0}, {10, 10}}, 0.25F));
  store.save_grid("map", ReflectionGrid(0.05, {{0, 0}, {2, 2}}, 0.75F));
  EXPECT_EQ(store.load_reflection_grid("map").size(), 4U);
  EXPECT_EQ(store.load_reflection_grid("map").values()[0], 0.75F);
}

TEST(Store, GivesAPatchMapBackExactly) {
  const TemporaryDirectory directory;
  const patch::PatchMap map = random_patch_map(3);
  Store store(directory.path() / "strata.db");
  EXPECT_FALSE(store.has_patch_map());
  store.save_patch_map(map);
  EXPECT_TRUE(store.has_patch_map());
  expect_same(store.load_patch_map(), map);
}

TEST(Store, ReplacesAPatchMapWithoutLeavings) {
  const TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  store.save_patch_map(random_patch_map(3));
  patch::PatchMap smaller = random_patch_map(4);
  smaller.submaps.resize(1);
  store.save_patch_map(smaller);
  expect_same(store.load_patch_map(), smaller);
  EXPECT_TRUE(store.has_grid("patch_map/patch/submap 0/configuration 0/counts"));
  EXPECT_FALSE(store.has_grid("patch_map/patch/submap 2/configuration 0/counts"));
  EXPECT_THAT(store.grid_names(), testing::IsEmpty());
}

TEST(Store, KeepsTrajectoriesPerRun) {
  const TemporaryDirectory directory;
  Eigen::Matrix3d covariance;
  covariance << 1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 1.0 / 3.0;
  const std::vector<TrajectoryPose> first{{{5}, {1.0 / 3.0, 2.0, -3.0}, covariance},
                                          {{4}, {0.0, -1e-300, 0.5}, std::nullopt}};
  const std::vector<TrajectoryPose> second{{{-9}, {7.0, 8.0, 0.25}, std::nullopt}};
  Store store(directory.path() / "strata.db");
  store.save_trajectory(0, second);
  store.save_trajectory(0, first);
  store.save_trajectory(3, second);
  EXPECT_THAT(store.runs(), testing::ElementsAre(0, 3));
  const auto loaded = store.load_trajectory(0);
  ASSERT_EQ(loaded.size(), 2U);
  EXPECT_EQ(loaded[0].stamp, first[0].stamp);
  EXPECT_EQ(loaded[0].map_from_robot, first[0].map_from_robot);
  EXPECT_EQ(loaded[0].covariance, first[0].covariance);
  EXPECT_EQ(loaded[1].map_from_robot, first[1].map_from_robot);
  EXPECT_FALSE(loaded[1].covariance);
  EXPECT_TRUE(store.load_trajectory(1).empty());
}

TEST(Store, GivesATimescaleMemoryBackByteForByte) {
  const TemporaryDirectory directory;
  TimescaleMemory memory({}, 9);
  PosedScan posed;
  posed.scan.angle_min_rad = -1.5F;
  posed.scan.angle_increment_rad = 0.01F;
  posed.scan.range_max_m = 20.0F;
  RandomStream random(1, StreamId::kTest);
  for (int t = 0; t < 200; ++t) {
    posed.scan.stamp = Stamp::from_seconds(t);
    posed.map_from_robot = {0.02 * t, 0.0, 0.05 * t};
    posed.scan.ranges_m.clear();
    for (int i = 0; i < 300; ++i) {
      posed.scan.ranges_m.push_back(static_cast<float>(random.normal(3.0, 0.1)));
    }
    memory.observe(posed);
  }
  ASSERT_GT(memory.nodes().size(), 1U);
  Store store(directory.path() / "strata.db");
  EXPECT_FALSE(store.has_timescale());
  store.save_timescale(memory);
  store.save_timescale(memory);
  EXPECT_TRUE(store.has_timescale());
  TimescaleMemory loaded = store.load_timescale();
  EXPECT_EQ(loaded.state(), memory.state());
  loaded.observe(posed);
  memory.observe(posed);
  EXPECT_EQ(loaded.state(), memory.state());
}

TEST(Store, KeepsTextsByKey) {
  const TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  store.save_text("summary/em", "{}");
  store.save_text("summary/em", std::string("a\0b", 3));
  store.save_text("config", "x: 1\n");
  EXPECT_EQ(store.find_text("summary/em"), std::string("a\0b", 3));
  EXPECT_EQ(store.find_text("missing"), std::nullopt);
  EXPECT_THAT(store.text_keys("summary/"), testing::ElementsAre("summary/em"));
  EXPECT_THAT(store.text_keys(), testing::ElementsAre("config", "summary/em"));
}

TEST(Store, SavesAllOfATransactionOrNothing) {
  const TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  EXPECT_THROW(store.transaction([&] {
    store.save_text("a", "1");
    store.save_patch_map(random_patch_map(1));
    throw std::runtime_error("stop");
  }),
               std::runtime_error);
  EXPECT_FALSE(store.find_text("a"));
  EXPECT_FALSE(store.has_patch_map());
  store.transaction([&] { store.save_text("a", "2"); });
  EXPECT_EQ(store.find_text("a"), "2");
}

TEST(Store, UndoesAnInnerTransactionAlone) {
  const TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  store.transaction([&] {
    store.save_text("outer", "1");
    EXPECT_THROW(store.transaction([&] {
      store.save_text("inner", "1");
      store.transaction([&] { store.save_text("innermost", "1"); });
      throw std::runtime_error("stop");
    }),
                 std::runtime_error);
    store.transaction([&] { store.save_text("another", "1"); });
  });
  EXPECT_THAT(store.text_keys(), testing::ElementsAre("another", "outer"));
}

TEST(Store, TakesTurnsWithAnotherWriter) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "strata.db";
  auto write = [&](const std::string& who) {
    for (int i = 0; i < 20; ++i) {
      Store store(path);
      store.save_text(who + std::to_string(i), "x");
    }
  };
  std::thread other([&] { write("a"); });
  write("b");
  other.join();
  EXPECT_EQ(Store(path).text_keys().size(), 40U);
}

TEST(Store, LetsReadersSeeTheOldValueWhileAnotherWrites) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "strata.db";
  Store writer(path);
  writer.save_text("state", "old");
  const Store reader(path, {.read_only = true});
  writer.transaction([&] {
    writer.save_text("state", "new");
    EXPECT_EQ(reader.find_text("state"), "old");
  });
  EXPECT_EQ(reader.find_text("state"), "new");
}

TEST(Store, LeavesOneFileWhenClosedByAWriterOrAReader) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "strata.db";
  const auto count_files = [&] {
    const std::filesystem::directory_iterator entries(directory.path());
    return std::distance(begin(entries), end(entries));
  };
  { Store(path).save_text("a", "b"); }
  EXPECT_EQ(count_files(), 1);
  {
    const Store reader(path, {.read_only = true});
    EXPECT_EQ(reader.find_text("a"), "b");
  }
  EXPECT_EQ(count_files(), 1);
}

}  // namespace
}  // namespace strata::memory
