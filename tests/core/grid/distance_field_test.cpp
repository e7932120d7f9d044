// SPDX-License-Identifier: Apache-2.0
#include "core/grid/distance_field.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

DistanceField by_brute_force(const Grid<std::uint8_t>& occupied) {
  DistanceField field(occupied.resolution_m(), occupied.rect(), kInf);
  for (std::size_t i = 0; i < field.size(); ++i) {
    const Cell a = field.cell(i);
    long best = -1;
    for (std::size_t k = 0; k < field.size(); ++k) {
      if (occupied.values()[k] == 0) continue;
      const Cell b = field.cell(k);
      const long squared =
          static_cast<long>(a.x - b.x) * (a.x - b.x) + static_cast<long>(a.y - b.y) * (a.y - b.y);
      if (best < 0 || squared < best) best = squared;
    }
    if (best < 0) continue;
    field.values()[i] =
        static_cast<float>(occupied.resolution_m() * std::sqrt(static_cast<double>(best)));
  }
  return field;
}

TEST(DistanceField, EqualsBruteForceBitForBit) {
  RandomStream random(1, StreamId::kTest);
  for (int round = 0; round < 300; ++round) {
    const int width = 1 + static_cast<int>(random.below(40));
    const int height = 1 + static_cast<int>(random.below(40));
    const int x = static_cast<int>(random.below(100)) - 50;
    Grid<std::uint8_t> occupied(0.05, {{x, -7}, {x + width, height - 7}}, 0);
    const double density = random.bernoulli(0.3) ? 0.003 : random.uniform(0.0, 0.6);
    for (auto& cell : occupied.values()) cell = random.bernoulli(density) ? 1 : 0;
    ASSERT_EQ(make_distance_field(occupied).values(), by_brute_force(occupied).values())
        << width << " x " << height << " round " << round;
  }
}

TEST(DistanceField, IsInfiniteWithoutObstaclesAndEmptyWithoutCells) {
  const Grid<std::uint8_t> empty(0.05, {{0, 0}, {5, 4}}, 0);
  const DistanceField field = make_distance_field(empty);
  for (const float d : field.values()) EXPECT_EQ(d, kInf);
  EXPECT_EQ(make_distance_field(Grid<std::uint8_t>(0.05, CellRect{})).size(), 0U);
}

TEST(DistanceField, IsExactBelowItsCut) {
  RandomStream random(2, StreamId::kTest);
  Grid<std::uint8_t> occupied(0.1, {{0, 0}, {60, 50}}, 0);
  for (auto& cell : occupied.values()) cell = random.bernoulli(0.003) ? 1 : 0;
  const DistanceField whole = make_distance_field(occupied);
  const DistanceField cut = make_distance_field(occupied, 0.7);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(cut.values()[i], std::min(whole.values()[i], 0.7F));
  }
}

TEST(DistanceField, MeasuresToKnownCellsOfOneQuarterAndMore) {
  ReflectionGrid map = make_reflection_grid(1.0, {{0, 0}, {5, 1}});
  map.values() = {0.25F, 0.0F, 0.249F, kUnknownReflection, 0.1F};
  EXPECT_EQ(make_distance_field(map).values(), (std::vector<float>{0.0F, 1.0F, 2.0F, 3.0F, 4.0F}));
}

}  // namespace
}  // namespace strata
