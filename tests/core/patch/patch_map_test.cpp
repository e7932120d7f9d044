// SPDX-License-Identifier: Apache-2.0
#include "core/patch/patch_map.hpp"

#include <gtest/gtest.h>

namespace strata::patch {
namespace {

Submap submap_of(int id, CellRect rect, std::vector<float> fills) {
  Submap submap;
  submap.id = id;
  submap.rect = rect;
  for (const float fill : fills) {
    Configuration c;
    c.reflection = ReflectionGrid(0.05, rect, fill);
    submap.configurations.push_back(c);
  }
  return submap;
}

PatchMap overlapping_map() {
  PatchMap map;
  map.base = ReflectionGrid(0.05, {{0, 0}, {40, 20}}, 0.25F);
  map.submaps.push_back(submap_of(0, {{0, 0}, {20, 20}}, {0.0F, 1.0F}));
  map.submaps.push_back(submap_of(1, {{16, 0}, {36, 20}}, {0.5F, kUnknownReflection}));
  return map;
}

TEST(SubmapAt, PrefersTheCurrentOneThenTheNearestCentre) {
  const PatchMap map = overlapping_map();
  const Eigen::Vector2d shared(17.5 * 0.05, 0.5);  // in both, nearer to the centre of 0
  EXPECT_EQ(submap_at(map, shared), 0);
  EXPECT_EQ(submap_at(map, shared, 1), 1);
  EXPECT_EQ(submap_at(map, {18.9 * 0.05, 0.5}), 1);
  EXPECT_EQ(submap_at(map, {39.0 * 0.05, 0.5}, 1), -1);
}

TEST(SubmapInReach, EntersFromAroundTheRectangleTheNearestFirst) {
  PatchMap map;
  map.base = ReflectionGrid(0.05, {{0, 0}, {80, 20}}, 0.25F);
  map.submaps.push_back(submap_of(0, {{0, 0}, {20, 20}}, {0.0F}));   // x to 1 m
  map.submaps.push_back(submap_of(1, {{40, 0}, {60, 20}}, {0.0F}));  // x from 2 m to 3 m
  EXPECT_EQ(submap_in_reach(map, {1.39, 0.5}, 0.4), 0);
  EXPECT_EQ(submap_in_reach(map, {1.41, 0.5}, 0.4), -1);
  EXPECT_EQ(submap_in_reach(map, {1.41, 0.5}, 0.4, 0), -1);
  // A corner is as far as its diagonal.
  EXPECT_EQ(submap_in_reach(map, {1.3, 1.3}, 0.42), -1);
  EXPECT_EQ(submap_in_reach(map, {1.3, 1.3}, 0.43), 0);
  // Within reach of both: the nearer, but the current one stays until another holds the point.
  EXPECT_EQ(submap_in_reach(map, {1.6, 0.5}, 1.0), 1);
  EXPECT_EQ(submap_in_reach(map, {1.6, 0.5}, 1.0, 0), 0);
  EXPECT_EQ(submap_in_reach(map, {2.01, 0.5}, 1.2, 0), 1);
  EXPECT_EQ(submap_in_reach(map, {1.5, 0.5}, 1.0), 0) << "equally near";
}

TEST(SubmapInReach, WithoutReachIsTheSubmapAtThePoint) {
  const PatchMap map = overlapping_map();
  for (double x = -0.105; x < 2.2; x += 0.005) {
    for (const int current : {-1, 0, 1}) {
      const Eigen::Vector2d point(x, 0.51);
      EXPECT_EQ(submap_in_reach(map, point, 0.0, current), submap_at(map, point, current)) << x;
    }
  }
}

TEST(Compose, PastesConfigurationsTheNearestCentreOnTop) {
  const PatchMap map = overlapping_map();
  const ReflectionGrid both = compose(map, {1, 0});
  EXPECT_EQ(both.get({5, 5}), 1.0F);
  EXPECT_EQ(both.get({17, 5}), 1.0F);
  EXPECT_EQ(both.get({18, 5}), 0.5F);
  EXPECT_EQ(compose(map, {1, 0}, 1).get({17, 5}), 0.5F);
  EXPECT_EQ(compose(map, {1, 0}, 0).get({18, 5}), 1.0F);
  EXPECT_EQ(both.get({38, 5}), 0.25F);
  const ReflectionGrid first = compose(map, {1, -1});
  EXPECT_EQ(first.get({17, 5}), 1.0F);
  EXPECT_EQ(first.get({30, 5}), 0.25F);
}

TEST(Compose, UnknownCellsOfAConfigurationLeaveTheBase) {
  EXPECT_EQ(compose(overlapping_map(), {-1, 1}).get({30, 5}), 0.25F);
}

}  // namespace
}  // namespace strata::patch
