// SPDX-License-Identifier: Apache-2.0
#include "core/patch/map_now.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace strata::patch {
namespace {

constexpr double kHorizon_s = 300.0;
constexpr float kFree = 0.1F;
constexpr float kWall = 0.6F;

Configuration filled(const CellRect& rect, float fill) {
  Configuration configuration;
  configuration.reflection = ReflectionGrid(0.05, rect, fill);
  return configuration;
}

/// A corridor with a wall in its row 9; a door of two cells at x = 5, 6 of row 4, and overlapping
/// it from x = 6 an area that is free, full, or of which nothing is known.
PatchMap corridor() {
  PatchMap map;
  map.base = make_reflection_grid(0.05, {{0, 0}, {20, 10}});
  for (int x = 0; x < 16; ++x) {
    for (int y = 0; y < 9; ++y) map.base.at({x, y}) = kFree;
    map.base.at({x, 9}) = kWall;
  }
  Submap door;
  door.rect = {{3, 2}, {8, 7}};
  for (const float leaf : {kFree, kWall}) {
    door.configurations.push_back(filled(door.rect, kFree));
    for (const int x : {5, 6}) door.configurations.back().reflection.at({x, 4}) = leaf;
  }
  Submap stacks;
  stacks.id = 1;
  stacks.rect = {{6, 2}, {18, 8}};
  for (const float all : {kFree, kWall, kUnknownReflection}) {
    stacks.configurations.push_back(filled(stacks.rect, all));
  }
  map.submaps = {door, stacks};
  return map;
}

TEST(ChangeProbability, IsThatOfAChainWhoseLikelierCellsAreNotAllThatIsLeft) {
  // Three configurations, a cell full in the first two: step by step, what has never left them.
  const double rate_per_s = 1.0 / 200.0;
  const double dt_s = 0.01;
  const Shares usual = {0.5, 0.2, 0.3};
  Shares held = {0.3, 0.5, 0.0};  // of belief, the third has 0.2
  const double fade = std::exp(-rate_per_s * dt_s);
  for (double t = 0.0; t < kHorizon_s - 0.5 * dt_s; t += dt_s) {
    const double sum = held[0] + held[1];
    for (std::size_t k = 0; k < 2; ++k) held[k] = fade * held[k] + (1.0 - fade) * usual[k] * sum;
  }
  const double expected = 1.0 - held[0] - held[1];
  EXPECT_GT(expected, 0.4);
  EXPECT_NEAR(change_probability(0.8, 0.7, rate_per_s, kHorizon_s), expected, 1e-5);
  EXPECT_NEAR(change_probability(0.2, 0.3, rate_per_s, kHorizon_s), expected, 1e-5)
      << "the other state is as good a name of it";
}

TEST(ChangeProbability, IsDoubtAloneWhereNothingChangesAndNoneWhereNothingIsInDoubt) {
  EXPECT_DOUBLE_EQ(change_probability(0.9, 0.5, 0.0, kHorizon_s), 1.0 - 0.9);
  EXPECT_DOUBLE_EQ(change_probability(0.9, 0.5, 1.0, 0.0), 1.0 - 0.9);
  EXPECT_DOUBLE_EQ(change_probability(1.0, 1.0, 1.0, kHorizon_s), 0.0);
  EXPECT_DOUBLE_EQ(change_probability(0.0, 0.0, 1.0, kHorizon_s), 0.0);
  // A door that is shut 96% of the time and is shut now, asked anew every ten minutes.
  EXPECT_NEAR(change_probability(1.0, 0.96, 1.0 / 600.0, 600.0), 1.0 - std::exp(-0.04), 1e-12);
  // It stands open: soon it will not.
  EXPECT_NEAR(change_probability(0.0, 0.96, 1.0 / 600.0, 600.0), 1.0 - std::exp(-0.96), 1e-12);
  EXPECT_LE(change_probability(0.5, 0.0, 1e6, 1e6), 1.0);
  EXPECT_GE(change_probability(1.0 + 1e-9, 1.0 + 1e-9, 1.0, 1.0), 0.0);
}

TEST(MapNow, MixesWhatConfigurationsSayAndKeepsWallsAndWhatIsUnknown) {
  const PatchMap map = corridor();
  const MapNow cells(map);
  EXPECT_EQ(cells.submaps(), 2U);
  EXPECT_EQ(cells.configurations(1), 3U);
  const ReflectionGrid now = cells.occupied(std::vector<Shares>{{0.3, 0.7}, {0.6, 0.1, 0.3}});
  EXPECT_EQ(now.get({1, 9}), 1.0F) << "a wall that most beams pass is one";
  EXPECT_EQ(now.get({1, 1}), 0.0F);
  EXPECT_FALSE(is_known(now.get({19, 1})));
  EXPECT_FLOAT_EQ(now.get({5, 4}), 0.7F);
  EXPECT_EQ(now.get({5, 5}), 0.0F);
  EXPECT_FLOAT_EQ(now.get({12, 4}), 0.1F) << "where it is not known the base says free";
  // Beyond the base one configuration says nothing: seven of ten know.
  EXPECT_FLOAT_EQ(now.get({17, 4}), 0.1F / 0.7F);
  const ReflectionGrid less = cells.occupied(std::vector<Shares>{{0.3, 0.7}, {0.3, 0.1, 0.6}});
  EXPECT_FALSE(is_known(less.get({17, 4})));
  EXPECT_FLOAT_EQ(less.get({12, 4}), 0.1F);
}

TEST(MapNow, OfSureConfigurationsIsTheMapThatBeamsAreTracedIn) {
  const PatchMap map = corridor();
  const MapNow cells(map);
  for (int door = 0; door < 2; ++door) {
    for (int stacks = 0; stacks < 3; ++stacks) {
      std::vector<Shares> beliefs = {{0.0, 0.0}, {0.0, 0.0, 0.0}};
      beliefs[0][static_cast<std::size_t>(door)] = 1.0;
      beliefs[1][static_cast<std::size_t>(stacks)] = 1.0;
      const ReflectionGrid now = cells.occupied(beliefs);
      const ReflectionGrid composed = compose(map, {door, stacks});
      ASSERT_EQ(now.rect(), composed.rect());
      for (std::size_t i = 0; i < now.size(); ++i) {
        const float m = composed.values()[i];
        ASSERT_EQ(is_known(now.values()[i]), is_known(m)) << i;
        if (!is_known(m)) continue;
        ASSERT_EQ(now.values()[i], is_occupied(m) ? 1.0F : 0.0F) << i;
      }
    }
  }
}

TEST(MapNow, ShowsChangeWhereConfigurationsDifferAndWithinReach) {
  PatchMap map = corridor();
  map.submaps.pop_back();
  // Of this one nobody knows anything.
  map.base.at({3, 2}) = kUnknownReflection;
  for (Configuration& state : map.submaps[0].configurations) {
    state.reflection.at({3, 2}) = kUnknownReflection;
  }
  const MapNow cells(map);
  const std::vector<SubmapOutlook> outlook = {{{0.1, 0.9}, {0.8, 0.2}, 1.0 / 900.0}};
  const auto leaf = static_cast<float>(change_probability(0.9, 0.2, 1.0 / 900.0, kHorizon_s));
  const Grid<float> bare = cells.change(outlook, kHorizon_s, 0.0);
  EXPECT_EQ(bare.rect(), cells.occupied(std::vector<Shares>{{0.1, 0.9}}).rect());
  for (std::size_t i = 0; i < bare.size(); ++i) {
    const Cell cell = bare.cell(i);
    const bool is_leaf = cell.y == 4 && (cell.x == 5 || cell.x == 6);
    ASSERT_EQ(bare.values()[i], is_leaf ? leaf : 0.0F) << cell.x << ", " << cell.y;
  }
  const Grid<float> wide = cells.change(outlook, kHorizon_s, 0.15);
  EXPECT_EQ(wide.get({2, 4}), leaf);
  EXPECT_EQ(wide.get({1, 4}), 0.0F);
  EXPECT_EQ(wide.get({9, 4}), leaf);
  EXPECT_EQ(wide.get({5, 7}), leaf);
  EXPECT_EQ(wide.get({3, 6}), leaf) << "two across and two up is within three";
  EXPECT_EQ(wide.get({2, 6}), 0.0F) << "three across and two up is not";
}

TEST(MapNow, ShowsTheGreatestChangeInReach) {
  PatchMap map = corridor();
  map.submaps[1].configurations.resize(2);
  const MapNow cells(map);
  const SubmapOutlook sure = {{0.1, 0.9}, {0.1, 0.9}, 0.0};
  const SubmapOutlook unsure = {{0.6, 0.4}, {0.6, 0.4}, 0.0};
  const Grid<float> change =
      cells.change(std::vector<SubmapOutlook>{sure, unsure}, kHorizon_s, 0.1);
  EXPECT_FLOAT_EQ(change.get({5, 4}), 0.1F);
  EXPECT_FLOAT_EQ(change.get({6, 4}), 0.4F) << "two beside the stacks";
  EXPECT_FLOAT_EQ(change.get({8, 4}), 0.4F);
  const Grid<float> other = cells.change(std::vector<SubmapOutlook>{unsure, sure}, kHorizon_s, 0.1);
  EXPECT_FLOAT_EQ(other.get({6, 4}), 0.4F) << "two beside the door";
  EXPECT_FLOAT_EQ(other.get({8, 4}), 0.4F);
  EXPECT_FLOAT_EQ(other.get({9, 4}), 0.1F);
}

}  // namespace
}  // namespace strata::patch
