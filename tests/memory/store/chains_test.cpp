// SPDX-License-Identifier: Apache-2.0
/// How patch maps change, in stores of this version and of those before.
#include <filesystem>

#include <gtest/gtest.h>

#include "memory/store/store.hpp"
#include "memory/store/store_summary.hpp"
#include "tests/memory/store/execute_sql.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

using test::TemporaryDirectory;

patch::PatchMap small_map() {
  patch::PatchMap map;
  map.base = make_reflection_grid(0.05, {{0, 0}, {40, 40}});
  map.entry_margin_m = 0.75;
  for (int s = 0; s < 3; ++s) {
    patch::Submap submap;
    submap.id = s;
    submap.rect = {{10 * s, 2}, {10 * s + 5, 11}};
    submap.contradictory = Grid<std::uint8_t>(0.05, submap.rect);
    submap.configurations.push_back(
        {Grid<CellCounts>(0.05, submap.rect), make_reflection_grid(0.05, submap.rect), 1.0});
    submap.change_rate_per_s = 0.001 * (s + 1);
    if (s == 1) submap.usual = {{0.25}, {{7, {0.5}, {-0.5}}, {1, {-1.0}, {2.0}}}};
    if (s == 2) submap.usual = {{-0.25}, {{14, {0.75}, {-1.5}}}};
    map.submaps.push_back(submap);
  }
  return map;
}

void expect_chains(const patch::PatchMap& got, const patch::PatchMap& expected) {
  EXPECT_EQ(got.entry_margin_m, expected.entry_margin_m);
  ASSERT_EQ(got.submaps.size(), expected.submaps.size());
  for (std::size_t s = 0; s < got.submaps.size(); ++s) {
    EXPECT_EQ(got.submaps[s].change_rate_per_s, expected.submaps[s].change_rate_per_s) << s;
    EXPECT_EQ(got.submaps[s].usual, expected.submaps[s].usual) << s;
  }
}

TEST(StoredChains, ComeBackAndAreNotAskedOfOlderStores) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "strata.db";
  patch::PatchMap map = small_map();
  { Store(path).save_patch_map(map); }
  expect_chains(Store(path, {.read_only = true}).load_patch_map(), map);
  EXPECT_EQ(summarize_store(path).patch_maps.at(0).in_time, 2);
  test::execute(path, "DROP TABLE submap_wave; PRAGMA user_version = 3");
  for (patch::Submap& submap : map.submaps) submap.usual = {};
  EXPECT_EQ(summarize_store(path).patch_maps.at(0).in_time, 0);
  expect_chains(Store(path, {.read_only = true}).load_patch_map(), map);
  test::execute(path, "DROP TABLE patch_entry; DROP TABLE submap_chain; PRAGMA user_version = 2");
  map.entry_margin_m = patch::kEntryMargin_m;
  for (patch::Submap& submap : map.submaps) submap.change_rate_per_s = 0.0;
  expect_chains(Store(path, {.read_only = true}).load_patch_map(), map);
  Store store(path);
  expect_chains(store.load_patch_map(), map);
  map.entry_margin_m = 0.5;
  map.submaps[0].usual = {{0.0}, {{3, {1.0}, {1.0}}}};
  store.save_patch_map(map);
  expect_chains(store.load_patch_map(), map);
}

TEST(StoredChains, WavesThatDoNotFitTheirConfigurationsAreDamage) {
  for (const char* damage :
       {"DELETE FROM submap_wave WHERE place = 0", "UPDATE submap_wave SET cycles_a_week = -7",
        "UPDATE submap_wave SET sine = 9e999",
        "INSERT INTO submap_wave VALUES ('patch', 1, 0, 0, 1, 0.0, 0.0)"}) {
    const TemporaryDirectory directory;
    const auto path = directory.path() / "strata.db";
    { Store(path).save_patch_map(small_map()); }
    test::execute(path, damage);
    EXPECT_THROW((void)Store(path, {.read_only = true}).load_patch_map(), InputError) << damage;
  }
}

}  // namespace
}  // namespace strata::memory
