// SPDX-License-Identifier: Apache-2.0
#include "core/patch/region_growing.hpp"

#include <gtest/gtest.h>

#include "core/base/config.hpp"
#include "core/base/error.hpp"

namespace strata::patch {
namespace {

constexpr double kResolution = 0.1;

Grid<std::uint8_t> mask_with(const std::vector<CellRect>& blocks) {
  Grid<std::uint8_t> mask(kResolution, {{0, 0}, {200, 200}}, 0);
  for (const CellRect& block : blocks) {
    for (int y = block.min.y; y < block.max.y; ++y) {
      for (int x = block.min.x; x < block.max.x; ++x) mask.at({x, y}) = 1;
    }
  }
  return mask;
}

ReflectionGrid free_map() { return {kResolution, {{0, 0}, {200, 200}}, 0.0F}; }

std::vector<Region> regions_of(const std::vector<CellRect>& blocks, const ReflectionGrid& map,
                               const RegionConfig& config = {}) {
  return merge_regions(grow_regions(mask_with(blocks), config), map, config);
}

TEST(RegionGrowing, JoinsCellsWithinTwiceTheDilationAndAddsTheMargin) {
  const auto regions = grow_regions(mask_with({{{50, 50}, {52, 52}}, {{57, 50}, {59, 52}}}), {});
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].rect, (CellRect{{45, 45}, {64, 57}}));
  EXPECT_EQ(regions[0].cells.size(), 8U);
  EXPECT_FALSE(regions[0].oversized);
  EXPECT_EQ(grow_regions(mask_with({{{50, 50}, {52, 52}}, {{62, 50}, {64, 52}}}), {}).size(), 2U);
}

TEST(RegionGrowing, NoContradictionNoRegion) { EXPECT_TRUE(regions_of({}, free_map()).empty()); }

TEST(RegionMerging, MergesNeighboursThatSeeEachOther) {
  const auto regions = regions_of({{{50, 50}, {54, 52}}, {{70, 50}, {74, 52}}}, free_map());
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].rect, (CellRect{{45, 45}, {79, 57}}));
}

TEST(RegionMerging, AWallBetweenThemKeepsThemApart) {
  ReflectionGrid map = free_map();
  for (int y = 0; y < 200; ++y) map.at({62, y}) = 1.0F;
  EXPECT_EQ(regions_of({{{50, 50}, {54, 52}}, {{70, 50}, {74, 52}}}, map).size(), 2U);
}

TEST(RegionMerging, TheirOwnOccupiedCellsDoNotBlockTheView) {
  ReflectionGrid map = free_map();
  for (int x = 50; x < 54; ++x) map.at({x, 51}) = 1.0F;
  for (int x = 50; x < 54; ++x) map.at({x, 70}) = 1.0F;
  EXPECT_EQ(regions_of({{{50, 50}, {54, 52}}, {{50, 70}, {54, 71}}}, map).size(), 1U);
}

TEST(RegionMerging, UnknownCellsDoNotBlockTheView) {
  const ReflectionGrid unknown = make_reflection_grid(kResolution, {{0, 0}, {200, 200}});
  EXPECT_EQ(regions_of({{{50, 50}, {54, 52}}, {{70, 50}, {74, 52}}}, unknown).size(), 1U);
}

TEST(RegionMerging, RegionsAcrossAWideGapStayApart) {
  EXPECT_EQ(regions_of({{{50, 50}, {54, 52}}, {{84, 50}, {88, 52}}}, free_map()).size(), 1U);
  EXPECT_EQ(regions_of({{{50, 50}, {54, 52}}, {{85, 50}, {89, 52}}}, free_map()).size(), 2U);
}

TEST(RegionMerging, StopsAtTheGreatestAreaSmallestUnionFirst) {
  RegionConfig config;
  config.max_area_m2 = 4.0;
  // Three in a row; a and b are nearer to each other than b and c.
  const auto regions = regions_of(
      {{{50, 50}, {52, 52}}, {{60, 50}, {62, 52}}, {{72, 50}, {74, 52}}}, free_map(), config);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].rect, (CellRect{{45, 45}, {67, 57}}));
  for (const Region& region : regions) {
    EXPECT_LE(static_cast<double>(region.rect.area()) * kResolution * kResolution, 4.0);
  }
}

TEST(RegionMerging, RectanglesMayOverlap) {
  RegionConfig config;
  config.max_area_m2 = 1.0;
  const auto regions = regions_of({{{50, 50}, {52, 52}}, {{59, 50}, {61, 52}}}, free_map(), config);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_FALSE(regions[0].rect.intersected(regions[1].rect).empty());
}

TEST(RegionMerging, ASingleLargeRegionIsKeptAndFlagged) {
  const auto regions = regions_of({{{20, 20}, {120, 60}}}, free_map());
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_TRUE(regions[0].oversized);
}

TEST(RegionMerging, KeepsEveryCellExactlyOnce) {
  const std::vector<CellRect> blocks{
      {{20, 20}, {24, 24}}, {{40, 20}, {44, 24}}, {{20, 40}, {24, 44}}, {{150, 150}, {153, 160}}};
  const Grid<std::uint8_t> mask = mask_with(blocks);
  Grid<std::uint8_t> seen(kResolution, mask.rect(), 0);
  for (const Region& region : regions_of(blocks, free_map())) {
    for (const Cell& cell : region.cells) {
      EXPECT_TRUE(region.rect.contains(cell));
      ++seen.at(cell);
    }
  }
  EXPECT_EQ(seen.values(), mask.values());
}

TEST(RegionGrouping, JoinsWhatHasTheSameNearestPlaceWhateverIsBetween) {
  RegionConfig config;
  config.places = {4.0, 4.0, 15.0, 15.0};
  const std::vector<CellRect> blocks{
      {{20, 20}, {24, 24}}, {{150, 150}, {153, 160}}, {{60, 60}, {64, 64}}};
  const auto regions =
      group_by_places(grow_regions(mask_with(blocks), config), kResolution, config);
  ASSERT_EQ(regions.size(), 2U);  // the third place has none
  EXPECT_EQ(regions[0].cells.size(), 32U);
  EXPECT_EQ(regions[0].rect, (CellRect{{15, 15}, {69, 69}}));
  EXPECT_EQ(regions[1].cells.size(), 30U);
  config.places.push_back(6.0);
  EXPECT_THROW(require_valid(config, "regions"), ConfigError);
}

}  // namespace
}  // namespace strata::patch
