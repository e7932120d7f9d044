// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/near_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::topology::detail {
namespace {

using Indices = std::vector<std::pair<std::size_t, std::size_t>>;

Indices indices(std::span<const Pair> pairs) {
  Indices result;
  for (const Pair& pair : pairs) result.emplace_back(pair.a, pair.b);
  return result;
}

/// By the definition: every two landmarks.
Indices of_every_two(const std::vector<std::size_t>& landmarks, const std::vector<Pose2>& poses,
                     double reach_m) {
  Indices result;
  for (std::size_t j = 1; j < landmarks.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const double x = poses[landmarks[j]].x - poses[landmarks[i]].x;
      const double y = poses[landmarks[j]].y - poses[landmarks[i]].y;
      if (x * x + y * y < reach_m * reach_m) result.emplace_back(landmarks[i], landmarks[j]);
    }
  }
  return result;
}

struct World {
  std::vector<Pose2> poses;
  std::vector<std::size_t> landmarks;  // two of three
};

/// On a lattice, so that many are exactly the reach apart.
World lattice(double width_m, double height_m, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 12);
  World world;
  for (std::size_t i = 0; i < 300; ++i) {
    world.poses.push_back({std::floor(random.uniform(0.0, width_m)),
                           std::floor(random.uniform(-height_m, 0.0)), 0.0});
    if (i % 3 != 1) world.landmarks.push_back(i);
  }
  return world;
}

TEST(NearPairs, AreThoseOfEveryTwoInTheirOrder) {
  for (const auto& [width_m, height_m] : {std::pair(200.0, 10.0), {10.0, 200.0}, {30.0, 30.0}}) {
    const World world = lattice(width_m, height_m, 1);
    const Indices expected = of_every_two(world.landmarks, world.poses, 5.0);
    EXPECT_GT(expected.size(), 300U);
    EXPECT_EQ(indices(near_pairs(world.landmarks, world.poses, 5.0)), expected);
  }
}

TEST(NearPairs, StayThoseOfEveryTwoWhileThePosesMove) {
  World world = lattice(60.0, 60.0, 2);
  NearPairs near(world.landmarks, 5.0);
  RandomStream random(3, StreamId::kTest, 12);
  std::size_t changed = 0;
  Indices before;
  for (const double step_m : {0.0, 0.01, 0.1, 0.1, 0.1, 0.3, 0.05, 2.0, 0.02, 0.4, 0.4, 0.4}) {
    for (Pose2& pose : world.poses) {
      pose.x += random.uniform(-step_m, step_m);
      pose.y += random.uniform(-step_m, step_m);
    }
    const Indices found = indices(near.at(world.poses));
    EXPECT_EQ(found, of_every_two(world.landmarks, world.poses, 5.0)) << step_m;
    changed += found != before ? 1 : 0;
    before = found;
  }
  EXPECT_GT(changed, 8U);
}

TEST(NearPairs, HaveNoLandmarkThatIsNowhere) {
  World world = lattice(20.0, 20.0, 4);
  NearPairs near(world.landmarks, 5.0);
  EXPECT_GT(near.at(world.poses).size(), 100U);
  world.poses[world.landmarks[5]].x = std::numeric_limits<double>::quiet_NaN();
  world.poses[world.landmarks[9]].y = std::numeric_limits<double>::infinity();
  const Indices expected = of_every_two(world.landmarks, world.poses, 5.0);
  EXPECT_EQ(indices(near.at(world.poses)), expected);
  EXPECT_TRUE(std::none_of(expected.begin(), expected.end(), [&](const auto& pair) {
    return pair.first == world.landmarks[5] || pair.second == world.landmarks[9];
  }));
}

TEST(NearPairs, OfNothingWithinNoReach) {
  const World world = lattice(5.0, 5.0, 5);
  EXPECT_TRUE(near_pairs(world.landmarks, world.poses, 0.0).empty());
  EXPECT_TRUE(near_pairs({}, world.poses, 5.0).empty());
}

}  // namespace
}  // namespace strata::topology::detail
