// SPDX-License-Identifier: Apache-2.0
#include "core/rays/ray_caster.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/ray_traversal.hpp"
#include "core/random/stream.hpp"
#include "tests/support/every_target.hpp"

namespace strata::rays {
namespace {

double slow_range(const ReflectionGrid& map, const Pose2& pose, double max_range_m) {
  const Eigen::Vector2d to =
      pose.translation() +
      max_range_m * Eigen::Vector2d(std::cos(pose.theta), std::sin(pose.theta));
  double travelled = 0.0;
  double range = std::numeric_limits<double>::infinity();
  traverse_ray(pose.translation(), to, map.resolution_m(), [&](const Cell& cell, double length_m) {
    if (is_occupied(map.get(cell))) {
      range = travelled + 0.5 * length_m;
      return false;
    }
    travelled += length_m;
    return true;
  });
  return range;
}

TEST(RayCaster, EqualsTheExactTraversal) {
  RandomStream random(17, StreamId::kTest);
  for (const double density : {0.002, 0.02, 0.2}) {
    ReflectionGrid map(0.05, {{-60, -50}, {80, 70}}, kUnknownReflection);
    for (float& m : map.values()) {
      m = random.bernoulli(density) ? 0.9F : (random.bernoulli(0.5) ? 0.1F : kUnknownReflection);
    }
    const RayCaster caster(map, 5.0);
    for (int n = 0; n < 20000; ++n) {
      const Pose2 pose{
          random.uniform(-4.0, 5.0), random.uniform(-3.5, 4.5),
          n % 5 == 0 ? 0.5 * std::numbers::pi * random.below(4) : random.uniform(-4.0, 4.0)};
      const double expected = slow_range(map, pose, 5.0);
      const double got = caster.expected_range_m(pose, 0.0);
      if (std::isinf(expected)) {
        EXPECT_EQ(got, expected);
      } else {
        EXPECT_NEAR(got, expected, 1e-9);
      }
    }
  }
}

TEST(RayCaster, IsNearASurfaceWithinADistanceOfItsCells) {
  ReflectionGrid map(0.05, {{0, 0}, {40, 40}}, 0.0F);
  map.at({20, 20}) = 1.0F;
  const RayCaster caster(map);
  RandomStream random(18, StreamId::kTest);
  for (int n = 0; n < 5000; ++n) {
    const Cell cell{static_cast<int>(random.below(40)), static_cast<int>(random.below(40))};
    const Eigen::Vector2d point = map.center(cell);
    const double distance_m = (point - map.center({20, 20})).norm();
    EXPECT_EQ(caster.is_near_surface(point, 0.3), distance_m <= 0.3 + 1e-6) << distance_m;
  }
  EXPECT_FALSE(caster.is_near_surface({2.5, 1.0}, 0.3));
  EXPECT_FALSE(RayCaster().is_near_surface({0.0, 0.0}, 0.3));
  ReflectionGrid edge(0.05, {{0, 0}, {40, 40}}, 0.0F);
  edge.at({39, 20}) = 1.0F;
  const RayCaster of_edge(edge);
  EXPECT_TRUE(of_edge.is_near_surface({2.22, 1.02}, 0.3));   // five cells beyond
  EXPECT_FALSE(of_edge.is_near_surface({2.32, 1.02}, 0.3));  // seven
}

TEST(RayKernel, EveryTargetGivesTheBitsOfTheScalarWalk) {
  RandomStream random(19, StreamId::kTest);
  for (const double density : {0.0, 0.002, 0.03, 0.3}) {
    Grid<std::uint8_t> marked(0.05, {{-60, -50}, {80, 70}});
    for (std::uint8_t& m : marked.values()) m = random.bernoulli(density) ? 1 : 0;
    const RayWalker walker(marked);
    for (int n = 0; n < 400; ++n) {
      // Inside, outside, on lattice lines; straight along the axes too.
      BeamBundle bundle;
      bundle.x_m = n % 7 == 0 ? 0.05 * random.below(40) : random.uniform(-4.0, 5.0);
      bundle.y_m = random.uniform(-3.5, 4.5);
      bundle.max_range_m = random.uniform(0.5, 9.0);
      if (n % 3 == 0) {
        const double heading = random.uniform(-4.0, 4.0);
        bundle.heading_cosine = std::cos(heading);
        bundle.heading_sine = std::sin(heading);
      }
      std::vector<double> cosine{1.0, 0.0, -1.0, 0.0};
      std::vector<double> sine{0.0, 1.0, 0.0, -1.0};
      for (int k = 0; k < 15; ++k) {
        const double angle = random.uniform(-4.0, 4.0);
        cosine.push_back(std::cos(angle));
        sine.push_back(std::sin(angle));
      }
      bundle.cosine = cosine.data();
      bundle.sine = sine.data();
      bundle.count = cosine.size();
      std::vector<double> expected(bundle.count, std::numeric_limits<double>::infinity());
      std::vector<std::int32_t> expected_cell(bundle.count, -1);
      for (std::size_t k = 0; k < bundle.count; ++k) {
        const double c = bundle.heading_cosine * cosine[k] - bundle.heading_sine * sine[k];
        const double s = bundle.heading_sine * cosine[k] + bundle.heading_cosine * sine[k];
        walker.walk(bundle.x_m, bundle.y_m, c, s, bundle.max_range_m,
                    [&](std::size_t index, double entry_m, double exit_m) {
                      expected[k] = 0.5 * (entry_m + exit_m);
                      expected_cell[k] = static_cast<std::int32_t>(index);
                      return false;
                    });
      }
      test::for_every_target([&] {
        std::vector<double> range(bundle.count);
        std::vector<std::int32_t> cell(bundle.count);
        cast_rays(walker.table(), bundle, range.data(), cell.data());
        ASSERT_EQ(range, expected);
        ASSERT_EQ(cell, expected_cell);
      });
    }
  }
}

TEST(RayCaster, MeetsNothingInAnEmptyMap) {
  const RayCaster caster(ReflectionGrid(0.05, {{0, 0}, {10, 10}}, 0.0F));
  EXPECT_TRUE(std::isinf(caster.expected_range_m({0.2, 0.2, 0.0}, 0.3)));
  EXPECT_TRUE(std::isinf(caster.expected_range_m({-50.0, 0.2, 0.0}, 0.0)));
}

}  // namespace
}  // namespace strata::rays
