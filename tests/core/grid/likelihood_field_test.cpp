// SPDX-License-Identifier: Apache-2.0
#include "core/grid/likelihood_field.hpp"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/grid/distance_field.hpp"
#include "core/random/stream.hpp"

namespace strata {
namespace {

ReflectionGrid random_map() {
  RandomStream random(1, StreamId::kTest);
  ReflectionGrid map = make_reflection_grid(0.05, {{-30, -20}, {40, 25}});
  for (float& m : map.values()) m = random.bernoulli(0.01) ? 0.8F : 0.1F;
  return map;
}

TEST(LikelihoodField, IsTheMixtureOfTheDistance) {
  const ReflectionGrid map = random_map();
  const LikelihoodFieldConfig config;
  const LikelihoodField field(map, config);
  const DistanceField distance = make_distance_field(map);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double d = std::min(static_cast<double>(distance.values()[i]), config.max_distance_m);
    const double expected = std::log(0.95 * std::exp(-d * d / (2.0 * 0.1 * 0.1)) + 0.05);
    ASSERT_NEAR(field.at(map.center(map.cell(i))), expected, 1e-6);
  }
}

TEST(LikelihoodField, IsAsFarAsItGetsOutsideTheMap) {
  const LikelihoodField field(random_map(), {});
  EXPECT_NEAR(field.at({100.0, 100.0}), std::log(0.05), 1e-6);
}

TEST(LikelihoodField, IsFlatOverAMapWithoutObstacles) {
  const LikelihoodField field(make_reflection_grid(0.05, {{0, 0}, {10, 10}}), {});
  for (const float value : field.log_likelihood().values())
    EXPECT_NEAR(value, std::log(0.05), 1e-6);
}

TEST(LikelihoodField, RefusesASpreadOfZero) {
  LikelihoodFieldConfig config;
  config.hit_stddev_m = 0.0;
  EXPECT_THROW(LikelihoodField(random_map(), config), ConfigError);
}

}  // namespace
}  // namespace strata
