// SPDX-License-Identifier: Apache-2.0
#include "core/localization/ray_caster.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/grid/ray_traversal.hpp"
#include "core/random/stream.hpp"

namespace strata::localization {
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

TEST(RayCaster, MeetsNothingInAnEmptyMap) {
  const RayCaster caster(ReflectionGrid(0.05, {{0, 0}, {10, 10}}, 0.0F));
  EXPECT_TRUE(std::isinf(caster.expected_range_m({0.2, 0.2, 0.0}, 0.3)));
  EXPECT_TRUE(std::isinf(caster.expected_range_m({-50.0, 0.2, 0.0}, 0.0)));
}

}  // namespace
}  // namespace strata::localization
