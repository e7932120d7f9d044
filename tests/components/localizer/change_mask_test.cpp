// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/change_mask.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "components/convert/map_messages.hpp"
#include "components/localizer/filter_mask.hpp"
#include "tests/support/nav2_costmap.hpp"

namespace strata::localizer {
namespace {

using test::nav2::kept_out_cost;
using test::nav2::kInscribed;
using test::nav2::kNoInformation;
using test::nav2::speed_limit;

/// A row of cells with chances to change of 0, 0.1%, 1%, ..., 100%; beyond them one that nobody
/// knows, beside what changes.
Grid<float> chances() {
  Grid<float> change(0.05, {{0, 0}, {103, 1}}, 0.0F);
  change.at({1, 0}) = 0.001F;
  for (int i = 1; i <= 100; ++i) change.at({i + 1, 0}) = static_cast<float>(i) / 100.0F;
  change.at({102, 0}) = 0.5F;
  return change;
}

ReflectionGrid floor_of(const Grid<float>& change) {
  ReflectionGrid occupied(change.resolution_m(), change.rect(), 0.0F);
  occupied.at({102, 0}) = kUnknownReflection;
  return occupied;
}

std::vector<std::int8_t> sent(const ChangeMaskConfig& config) {
  const Grid<float> change = chances();
  return convert::to_occupancy(mask_of(change, floor_of(change), config), Stamp(), "map").data();
}

TEST(ChangeMask, CostsInAKeepoutFilterByTheProbabilityAndMakesNoWallsAndNoFreeCells) {
  for (const int strongest : {99, 40}) {
    const ChangeMaskConfig config{.kind = ChangeMaskKind::kPenalty, .max_penalty = strongest};
    const auto info =
        filter_info(meaning_of(config), "/change_mask", Stamp::from_seconds(3.0), "map");
    EXPECT_EQ(info.type(), 0);
    EXPECT_EQ(info.base(), 0.0F) << "KeepoutFilter takes no other";
    EXPECT_EQ(info.multiplier(), 1.0F);
    const auto mask = sent(config);
    for (const std::size_t quiet : {0U, 1U, 102U}) {
      EXPECT_EQ(kept_out_cost(mask[quiet], kNoInformation), kNoInformation) << quiet;
      EXPECT_EQ(kept_out_cost(mask[quiet], 17), 17) << quiet;
    }
    int before = 0;
    for (int percent = 2; percent <= 100; ++percent) {
      const int cost = kept_out_cost(mask[static_cast<std::size_t>(percent) + 1], 0);
      EXPECT_NEAR(cost, percent / 100.0 * strongest / 100.0 * 254.0, 2.0) << percent;
      EXPECT_GE(cost, before);
      before = cost;
    }
    EXPECT_GT(before, 0.9 * strongest / 100.0 * 254.0);
    EXPECT_LT(before, kInscribed) << "sure to change is no wall";
    EXPECT_EQ(kept_out_cost(mask[101], test::nav2::kLethal), test::nav2::kLethal);
  }
}

TEST(ChangeMask, SlowsInASpeedFilterFromNoLimitToTheLowestSpeed) {
  for (const double lowest : {30.0, 1.0, 100.0}) {
    const ChangeMaskConfig config{.kind = ChangeMaskKind::kSpeed, .min_speed = lowest};
    const auto info =
        filter_info(meaning_of(config), "/r/change_mask", Stamp::from_seconds(3.0), "map");
    EXPECT_EQ(info.type(), 1);
    EXPECT_EQ(info.filter_mask_topic(), "/r/change_mask");
    EXPECT_EQ(info.header().frame_id(), "map");
    const auto mask = sent(config);
    const auto limit = [&](std::size_t cell) {
      const auto found = speed_limit(mask[cell], info.base(), info.multiplier());
      EXPECT_TRUE(found) << "SpeedFilter refuses unknown cells, such as " << cell;
      return found.value_or(-1.0);
    };
    EXPECT_EQ(limit(0), 0.0);
    EXPECT_EQ(limit(1), 0.0);
    for (int percent = 1; percent <= 100; ++percent) {
      EXPECT_NEAR(limit(static_cast<std::size_t>(percent) + 1),
                  100.0 - percent * (100.0 - lowest) / 100.0, 1e-3);
    }
    EXPECT_GT(limit(101), 0.5) << "0 would be no limit";
    EXPECT_GT(limit(102), 0.0);
  }
}

TEST(ChangeMask, LooksAheadByTheChainsOfTheFilterAndWhatItBelieves) {
  patch::PatchMap map;
  map.base = make_reflection_grid(0.05, {{0, 0}, {8, 4}});
  for (int s = 0; s < 2; ++s) {
    patch::Submap submap;
    submap.id = s;
    submap.rect = {{4 * s, 0}, {4 * s + 4, 4}};
    for (int k = 0; k < 2 + s; ++k) {
      patch::Configuration configuration;
      configuration.reflection = ReflectionGrid(0.05, submap.rect, 0.0F);
      configuration.prior = k == 0 ? 0.6 : 0.4 / (1 + s);
      submap.configurations.push_back(configuration);
    }
    submap.change_rate_per_s = 0.01 * (s + 1);
    map.submaps.push_back(std::move(submap));
  }
  const localization::PatchStates states(std::make_shared<const patch::PatchMap>(map), {});
  const std::vector<patch::Shares> beliefs = {{0.9, 0.1}, {0.2, 0.3, 0.5}};
  const auto outlook = outlook_of(states, states.usual(), beliefs);
  ASSERT_EQ(outlook.size(), 2U);
  EXPECT_EQ(outlook[0].now, beliefs[0]);
  EXPECT_EQ(outlook[1].now, beliefs[1]);
  EXPECT_NEAR(outlook[0].usual[1], 0.4, 1e-6);
  ASSERT_EQ(outlook[1].usual.size(), 3U);
  EXPECT_NEAR(outlook[1].usual[0], 0.6, 1e-6);
  EXPECT_NEAR(outlook[1].usual[2], 0.2, 1e-6);
  EXPECT_DOUBLE_EQ(outlook[0].rate_per_s, 0.01);
  EXPECT_DOUBLE_EQ(outlook[1].rate_per_s, 0.02);
}

TEST(ChangeMask, IsOfModelsWithSubmaps) {
  for (const char* model : {"patch", "patch_shared", "patch_places"}) {
    EXPECT_TRUE(has_change_mask(*maps::map_models().at(model))) << model;
  }
  for (const char* model : {"occupancy", "filtered", "timescale", "timescale_long"}) {
    EXPECT_FALSE(has_change_mask(*maps::map_models().at(model))) << model;
  }
}

}  // namespace
}  // namespace strata::localizer
