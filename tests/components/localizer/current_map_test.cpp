// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/current_map.hpp"

#include <gtest/gtest.h>

#include "tests/components/maps/toy_model.hpp"

namespace strata::localizer {
namespace {

constexpr float kFree = 0.1F;
constexpr float kWall = 0.9F;
const Cell kDoor{4, 1};
const Cell kBeside{6, 3};

patch::Configuration door(const CellRect& rect, float reflection, double prior) {
  patch::Configuration configuration{{}, make_reflection_grid(0.1, rect), prior};
  configuration.reflection.at({rect.min.x + 1, rect.min.y + 1}) = reflection;
  return configuration;
}

/// Two doors, seen closed more often than open.
maps::Maps doors() {
  maps::Maps maps;
  maps.filtered = make_reflection_grid(0.1, {{0, 0}, {9, 4}});
  maps.occupancy = maps.filtered;
  maps.occupancy.at(kBeside) = kWall;
  patch::PatchMap patches;
  patches.base = maps.filtered;
  patches.base.at(kBeside) = kFree;
  for (int id = 0; id < 2; ++id) {
    const CellRect rect = id == 0 ? CellRect{{3, 0}, {5, 2}} : CellRect{{7, 0}, {9, 2}};
    patch::Submap submap;
    submap.id = id;
    submap.rect = rect;
    submap.configurations = {door(rect, kFree, 0.3), door(rect, kWall, 0.7)};
    patches.submaps.push_back(std::move(submap));
  }
  maps.patches = std::move(patches);
  return maps;
}

TEST(CurrentMap, BeginsWithWhatWasSeenMostAndShowsADoorWhenItIsMoreLikelyOpenThanNot) {
  CurrentMap map(doors(), *maps::map_models().at("patch"));
  const auto first = map.news({});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->at(kDoor), kWall);
  EXPECT_EQ(first->at({8, 1}), kWall);
  EXPECT_EQ(first->at(kBeside), kFree);
  EXPECT_FALSE(map.news({}));
  EXPECT_FALSE(map.news({{0, 1.0, {0.5, 0.5}}}));
  const auto open = map.news({{0, 0.2, {0.6, 0.4}}, {1, 0.0, {0.2, 0.8}}});
  ASSERT_TRUE(open);
  EXPECT_EQ(open->at(kDoor), kFree);
  EXPECT_EQ(open->at({8, 1}), kWall);
  EXPECT_FALSE(map.news({{0, 1.0, {0.9, 0.1}}}));
  // Who is elsewhere believes nothing new of it.
  EXPECT_FALSE(map.news({{1, 1.0, {0.3, 0.7}}}));
  EXPECT_FALSE(map.news({{7, 1.0, {1.0}}}));
  const auto closed = map.news({{0, 1.0, {0.1, 0.9}}});
  ASSERT_TRUE(closed);
  EXPECT_EQ(closed->at(kDoor), kWall);
}

TEST(CurrentMap, OfAModelWithoutSubmapsIsItsMapAndComesOnce) {
  CurrentMap occupancy(doors(), *maps::map_models().at("occupancy"));
  const auto map = occupancy.news({});
  ASSERT_TRUE(map);
  EXPECT_EQ(map->at(kBeside), kWall);
  EXPECT_FALSE(occupancy.news({}));
  CurrentMap levels(doors(), *maps::map_models().at("timescale_long"));
  const auto filtered = levels.news({});
  ASSERT_TRUE(filtered);
  EXPECT_NE(filtered->at(kBeside), kWall);
}

TEST(CurrentMap, OfAModelThatIsOnlyRegisteredIsTheGridThatItIsMadeOf) {
  CurrentMap toy(doors(), maps::test_room::toy_model());
  const auto map = toy.news({});
  ASSERT_TRUE(map);
  EXPECT_EQ(map->at(kBeside), kWall);
}

}  // namespace
}  // namespace strata::localizer
