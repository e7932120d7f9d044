// SPDX-License-Identifier: Apache-2.0
#include "core/slam/learned_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/core/refinement/surveyed_world.hpp"

namespace strata {
namespace {

using test::crooked_room;
using test::places;
using test::scans_at;

TEST(LearnedSurfaces, LieOnTheWallWhereverInItsCellsThatIs) {
  const auto scans = scans_at(crooked_room(), places(1.0, 2.0, 7.0, 4.0, 1.0), 3);
  const SurfaceLayer layer = slam::learned_surfaces(scans, 0.05);
  std::size_t on_wall = 0;  // the upper wall, at 6.031 m
  for (std::size_t i = 0; i < layer.cells.size(); ++i) {
    const Eigen::Vector2d at = layer.position_m(i);
    if (at.x() < 3.5 || at.x() > 4.5 || at.y() < 6.0 || at.y() >= 6.05) continue;
    ++on_wall;
    EXPECT_NEAR(at.y(), 6.031, 0.006) << at.x();
    const double normal_rad = (layer.cells[i].normal + 0.5) / 256.0 * std::numbers::pi;
    EXPECT_NEAR(normal_rad, std::numbers::pi / 2.0, 0.15) << at.x();
  }
  EXPECT_GE(on_wall, 15U);
  EXPECT_LE(on_wall, 40U);
}

TEST(LearnedSurfaces, AreNoneOfBeamsThatEndedAtWhatMoves) {
  auto scans = scans_at(crooked_room(), {{4.0, 3.0, 0.0}}, 3);
  scans[0].static_probability.assign(scans[0].scan.size(), 0.0F);
  EXPECT_TRUE(slam::learned_surfaces(scans, 0.05).cells.empty());
}

TEST(LearnedSurfaces, AreNoneWhereMostThatEndedThereMoved) {
  auto scans = scans_at(crooked_room(), {{4.0, 3.0, 0.0}}, 3);
  ASSERT_FALSE(slam::learned_surfaces(scans, 0.05).cells.empty());
  const PosedScan once = scans[0];
  for (int i = 0; i < 20; ++i) {
    scans.push_back(once);
    scans.back().static_probability.assign(once.scan.size(), 0.0F);
  }
  EXPECT_TRUE(slam::learned_surfaces(scans, 0.05).cells.empty());
}

TEST(LearnedSurfaces, AreOneACellAndSorted) {
  const auto scans = scans_at(crooked_room(), places(1.0, 2.0, 7.0, 4.0, 0.7), 4, 0.03);
  const SurfaceLayer layer = slam::learned_surfaces(scans, 0.05);
  ASSERT_GT(layer.cells.size(), 100U);
  EXPECT_TRUE(std::is_sorted(layer.cells.begin(), layer.cells.end(),
                             [](const SurfaceCell& a, const SurfaceCell& b) {
                               return std::pair(a.y, a.x) < std::pair(b.y, b.x);
                             }));
  for (std::size_t i = 1; i < layer.cells.size(); ++i) {
    EXPECT_FALSE(layer.cell(i) == layer.cell(i - 1));
  }
}

TEST(LearnedSurfaces, OfNoScansAreNone) {
  const SurfaceLayer layer = slam::learned_surfaces({}, 0.05);
  EXPECT_TRUE(layer.cells.empty());
  EXPECT_EQ(layer.resolution_m, 0.05);
}

}  // namespace
}  // namespace strata
