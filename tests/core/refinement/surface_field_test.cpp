// SPDX-License-Identifier: Apache-2.0
#include "core/refinement/surface_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <gtest/gtest.h>

namespace strata::refinement {
namespace {

/// Ten by ten cells of 5 cm. Cells with y = 8 are a wall; a door in a sub-map is at y = 5.
struct Small {
  ReflectionGrid map = make_reflection_grid(0.05, {{0, 0}, {10, 10}});
  SurfaceLayer layer{0.05, {}};
  patch::PatchMap patches;

  Small() {
    for (float& value : map.values()) value = 0.0F;
    for (int x = 0; x < 10; ++x) {
      map.at({x, 8}) = 1.0F;
      for (const int y : {3, 5, 8}) layer.cells.push_back({x, y, 64, 192, 127, 0});
    }
    std::sort(layer.cells.begin(), layer.cells.end(), [](const auto& a, const auto& b) {
      return std::pair(a.y, a.x) < std::pair(b.y, b.x);
    });
    patches.base = map;
    patch::Submap submap;
    submap.rect = {{2, 2}, {7, 7}};
    for (const float door : {0.0F, 1.0F}) {
      patch::Configuration configuration;
      configuration.reflection = map.cropped(submap.rect);
      for (int x = 2; x < 7; ++x) configuration.reflection.at({x, 5}) = door;
      submap.configurations.push_back(configuration);
    }
    patches.submaps.push_back(submap);
  }
};

std::size_t counting(const SurfaceField& surfaces) {
  const auto& points = surfaces.field().points();
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(),
                                                [](const auto& point) { return point.occupied; }));
}

TEST(SurfaceField, HasSurfacesWhereTheMapIsOccupiedAndNowhereElse) {
  const Small small;
  const SurfaceField surfaces(small.map, small.layer, nullptr);
  ASSERT_EQ(counting(surfaces), 10U);
  const registration::SurfacePoint* point = surfaces.field().nearest(0.21, 0.42);
  ASSERT_NE(point, nullptr);
  EXPECT_NEAR(point->x_m, 4 * 0.05 + 0.25 * 0.05, 2e-4);
  EXPECT_NEAR(point->y_m, 8 * 0.05 + 0.75 * 0.05, 2e-4);
  EXPECT_NEAR(std::abs(point->normal_y), 1.0, 1e-3);
  EXPECT_EQ(surfaces.stddev_m(), 0.0);
}

TEST(SurfaceField, TakesAreasThatChangeAsTheyAreBelievedToBe) {
  const Small small;
  SurfaceField surfaces(small.map, small.layer, &small.patches);
  EXPECT_EQ(surfaces.changing(), 5U);
  const auto believed = [&](double closed) {
    surfaces.believe({{0, 1.0, {1.0 - closed, closed}}}, 0.9);
    return counting(surfaces);
  };
  EXPECT_EQ(believed(0.95), 15U);
  EXPECT_EQ(believed(0.5), 10U);
  EXPECT_EQ(surfaces.field().nearest(0.2, 0.26), nullptr) << "it matches nothing, nor the wall";
  EXPECT_EQ(believed(0.05), 10U);
  surfaces.believe({}, 0.9);
  EXPECT_EQ(counting(surfaces), 10U) << "nothing is known";
  EXPECT_EQ(believed(0.95), 15U);
}

TEST(SurfaceField, OfCellsThatNoConfigurationHasAreNone) {
  const Small small;  // hits at y = 3 inside the sub-map
  const SurfaceField surfaces(small.map, small.layer, &small.patches);
  EXPECT_EQ(surfaces.field().points().size(), 15U);
}

TEST(SurfaceField, LieInTheMiddleOfTheirCellsWhereNobodyKnowsBetter) {
  const Small small;
  for (const SurfaceLayer& layer : {SurfaceLayer{}, SurfaceLayer{0.1, small.layer.cells}}) {
    const SurfaceField surfaces(small.map, layer, nullptr);
    ASSERT_EQ(counting(surfaces), 10U);
    EXPECT_NEAR(surfaces.field().points()[0].y_m, 8.5 * 0.05, 1e-9);
    EXPECT_NEAR(surfaces.stddev_m(), 0.05 / std::sqrt(12.0), 1e-9);
  }
}

}  // namespace
}  // namespace strata::refinement
