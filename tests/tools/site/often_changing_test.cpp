// SPDX-License-Identifier: Apache-2.0
#include "tools/site/often_changing.hpp"

#include <gtest/gtest.h>

namespace strata::site {
namespace {

/// A leaf of three cells that is there or not, in an area of its own.
patch::Submap door(const Cell& leaf, double rate_per_s) {
  patch::Submap submap;
  submap.rect = CellRect{leaf, {leaf.x + 3, leaf.y + 1}}.inflated(3);
  submap.change_rate_per_s = rate_per_s;
  for (const float reflection : {0.9F, 0.02F}) {
    patch::Configuration state;
    state.reflection = ReflectionGrid(0.1, submap.rect, 0.02F);
    for (int x = 0; x < 3; ++x) state.reflection.at({leaf.x + x, leaf.y}) = reflection;
    submap.configurations.push_back(state);
  }
  return submap;
}

TEST(OftenChanging, ProposesThePlacesThatChangeTheFastestFirst) {
  patch::PatchMap map;
  map.base = ReflectionGrid(0.1, {{0, 0}, {50, 50}}, 0.02F);
  map.submaps = {door({10, 10}, 0.0), door({30, 30}, 1.0 / 600.0), door({20, 40}, 1.0 / 60.0)};
  for (int s = 0; s < 3; ++s) map.submaps[static_cast<std::size_t>(s)].id = s;
  // One whose configurations say the same of every cell.
  patch::Submap still = door({40, 10}, 1.0);
  still.id = 3;
  still.configurations[1] = still.configurations[0];
  map.submaps.push_back(still);
  const Zones zones = often_changing(map, "map");
  ASSERT_EQ(zones.zones.size(), 3U);
  EXPECT_EQ(zones.zones[0].name, "changes 2");
  EXPECT_EQ(zones.zones[1].name, "changes 1");
  const auto& properties = zones.document["features"][1]["properties"];
  EXPECT_NEAR(properties["changes_per_hour"], 6.0, 1e-9);
  EXPECT_TRUE(zones.document["features"][2]["properties"]["changes_per_hour"].is_null());
  EXPECT_EQ(zones.zones[1].control, LearnControl::kLearn) << "as it is, it changes nothing";
  EXPECT_NEAR(area_m2(zones.zones[1]), 15 * 0.01, 1e-9) << "three cells, and those beside them";
  EXPECT_TRUE(contains(zones.zones[1].shape.at(0), {3.15, 3.05}));
  EXPECT_EQ(parse_zones(to_text(zones), "again").zones.size(), 3U);
}

}  // namespace
}  // namespace strata::site
