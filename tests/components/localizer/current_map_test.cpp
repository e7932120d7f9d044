// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/current_map.hpp"

#include <gtest/gtest.h>

#include "components/convert/map_messages.hpp"
#include "tests/components/maps/toy_model.hpp"
#include "tests/support/nav2_costmap.hpp"

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

Stamp at(double time_s) { return Stamp::from_seconds(time_s); }

/// Of the first door and, where it is said, of the other.
std::vector<localization::SubmapBelief> believing(double open, double other_open = 0.3) {
  return {{0, 0.2, {open, 1.0 - open}}, {1, 0.0, {other_open, 1.0 - other_open}}};
}

TEST(CurrentMap, SaysHowLikelyADoorIsShutByWhatIsBelievedAndBeforeByWhatIsUsual) {
  CurrentMap map(doors(), *maps::map_models().at("patch"), {});
  const auto first = map.news({}, {}, at(0.0));
  ASSERT_TRUE(first);
  EXPECT_FLOAT_EQ(first->at(kDoor), 0.7F);
  EXPECT_FLOAT_EQ(first->at({8, 1}), 0.7F);
  EXPECT_EQ(first->at(kBeside), 0.0F);
  EXPECT_FALSE(is_known(first->at({0, 3})));
  const auto open = map.news(believing(0.9, 0.2), {}, at(1.0));
  ASSERT_TRUE(open);
  EXPECT_FLOAT_EQ(open->at(kDoor), 0.1F);
  EXPECT_FLOAT_EQ(open->at({8, 1}), 0.8F);
  EXPECT_EQ(map.beliefs()[0], (patch::Shares{0.9, 1.0 - 0.9}));
}

TEST(CurrentMap, CostsInAStaticLayerOfNav2AsFarAsADoorIsBelievedShut) {
  CurrentMap map(doors(), *maps::map_models().at("patch"), {.min_period_s = 0.0});
  const auto cost_of = [&](double open, const Cell& cell) {
    const auto grid = map.news(believing(open), {}, at(0.0));
    EXPECT_TRUE(grid);
    if (!grid) return -1;
    const auto message = convert::to_occupancy(*grid, Stamp(), "map");
    return test::nav2::static_cost(message.data()[grid->index(cell)], 90);
  };
  EXPECT_EQ(cost_of(0.05, kDoor), test::nav2::kLethal);
  EXPECT_EQ(cost_of(0.3, kDoor), 70 * 254 / 90);
  EXPECT_EQ(cost_of(0.999, kDoor), 0);
  EXPECT_EQ(cost_of(0.5, {0, 3}), test::nav2::kNoInformation);
  EXPECT_EQ(cost_of(0.7, kBeside), 0);
}

TEST(CurrentMap, ComesAgainWhenABeliefHasMovedNoticeablyNoMatterInHowManySteps) {
  CurrentMap map(doors(), *maps::map_models().at("patch"), {});
  ASSERT_TRUE(map.news(believing(0.5), {}, at(0.0)));
  EXPECT_FALSE(map.news(believing(0.5), {}, at(10.0)));
  EXPECT_FALSE(map.news(believing(0.6), {}, at(20.0)));
  EXPECT_TRUE(map.news(believing(0.65), {}, at(30.0)));
  // The other door is believed in for itself.
  EXPECT_FALSE(map.news(believing(0.65, 0.31), {}, at(40.0)));
  EXPECT_TRUE(map.news(believing(0.65, 0.9), {}, at(50.0)));
  // From nearly sure to sure is news, though the step is small.
  EXPECT_TRUE(map.news(believing(0.97, 0.9), {}, at(60.0)));
  EXPECT_TRUE(map.news(believing(0.999, 0.9), {}, at(70.0)));
  EXPECT_FALSE(map.news(believing(0.995, 0.9), {}, at(80.0)));
}

TEST(CurrentMap, ComesNotWithinTheLeastPeriodButThenWithAllThatHasMoved) {
  CurrentMap map(doors(), *maps::map_models().at("patch"), {.min_period_s = 2.0});
  ASSERT_TRUE(map.news(believing(0.5), {}, at(100.0)));
  EXPECT_FALSE(map.news(believing(0.9), {}, at(101.9)));
  const auto later = map.news({}, {}, at(102.0));
  ASSERT_TRUE(later);
  EXPECT_FLOAT_EQ(later->at(kDoor), 0.1F);
  EXPECT_TRUE(map.news(believing(0.5), {}, at(3.0))) << "a clock that was set back";
}

TEST(CurrentMap, ComesWhenWhatIsUsualMovesAsFarAsThatIsAsked) {
  CurrentMap map(doors(), *maps::map_models().at("patch"), {});
  const std::vector<float> morning = {0.3F, 0.7F, 0.3F, 0.7F};
  const std::vector<float> noon = {0.3F, 0.7F, 0.8F, 0.2F};
  ASSERT_TRUE(map.news({}, morning, at(0.0)));
  EXPECT_FALSE(map.news({}, morning, at(10.0)));
  EXPECT_TRUE(map.news({}, noon, at(20.0)));
}

TEST(CurrentMap, HearsNothingOfSubmapsThatItDoesNotHave) {
  CurrentMap map(doors(), *maps::map_models().at("patch"), {});
  ASSERT_TRUE(map.news({}, {}, at(0.0)));
  EXPECT_FALSE(map.news({{7, 1.0, {1.0}}, {-1, 1.0, {1.0}}, {0, 1.0, {1.0}}}, {}, at(10.0)));
}

TEST(CurrentMap, OfAModelWithoutSubmapsIsItsMapAndComesOnce) {
  CurrentMap occupancy(doors(), *maps::map_models().at("occupancy"), {});
  const auto map = occupancy.news({}, {}, at(0.0));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->at(kBeside), 1.0F) << "what stops a beam is a wall";
  EXPECT_FALSE(occupancy.news({}, {}, at(10.0)));
  CurrentMap levels(doors(), *maps::map_models().at("timescale_long"), {});
  const auto filtered = levels.news({}, {}, at(0.0));
  ASSERT_TRUE(filtered);
  EXPECT_FALSE(is_known(filtered->at(kBeside)));
}

TEST(CurrentMap, OfAModelThatIsOnlyRegisteredIsTheGridThatItIsMadeOf) {
  CurrentMap toy(doors(), maps::test_room::toy_model(), {});
  const auto map = toy.news({}, {}, at(0.0));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->at(kBeside), 1.0F);
}

}  // namespace
}  // namespace strata::localizer
