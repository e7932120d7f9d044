// SPDX-License-Identifier: Apache-2.0
#include "core/topology/cloud_matcher.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/core/topology/junction_world.hpp"

namespace strata::topology {
namespace {

/// The walls of a kind seen from a pose, with the noise of a laser.
LocalCloud seen_from(int kind, const Pose2& place_from_robot, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 7);
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector2d& point : test_world::wall_points({.kind = kind})) {
    points.push_back(inverse(place_from_robot) * point +
                     Eigen::Vector2d(random.normal(0.0, 0.02), random.normal(0.0, 0.02)));
  }
  return with_normals(points, 5);
}

TEST(LocalCloud, NormalsStandOnTheirWalls) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 20; ++i) points.emplace_back(0.1 * i, 2.0);
  points.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0.0);
  points.emplace_back(50.0, 50.0);  // alone: no normal
  const LocalCloud cloud = with_normals(points, 5);
  ASSERT_EQ(cloud.size(), 20U);
  for (const Eigen::Vector2d& normal : cloud.normals) {
    EXPECT_NEAR(std::abs(normal.y()), 1.0, 1e-9);
  }
}

TEST(NearestPoint, FindsWhatAPlainSearchFinds) {
  RandomStream random(5, StreamId::kTest);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 300; ++i) {
    points.emplace_back(random.uniform(-4.0, 4.0), random.uniform(-2.0, 3.0));
  }
  const NearestPoint nearest(points, 0.5);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d at(random.uniform(-6.0, 6.0), random.uniform(-4.0, 5.0));
    const double gate_m = random.uniform(0.05, 0.8);
    std::size_t expected = NearestPoint::kNone;
    double best = std::min(gate_m, 0.5);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if ((points[k] - at).norm() > best) continue;
      best = (points[k] - at).norm();
      expected = k;
    }
    EXPECT_EQ(nearest.find(at, gate_m), expected);
  }
  EXPECT_EQ(NearestPoint({}, 0.5).find({0.0, 0.0}, 0.5), NearestPoint::kNone);
}

TEST(PlaceSurface, FindsAPointAboutAsNearAsTheNearest) {
  const LocalCloud cloud = seen_from(7, {0.3, -0.2, 0.4}, 3);
  const PlaceSurface surface(cloud, 0.5);
  const NearestPoint nearest(cloud.points_m, 0.5);
  RandomStream random(6, StreamId::kTest);
  int found = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector2d at(random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0));
    const std::size_t exact = nearest.find(at, 0.3);
    ASSERT_EQ(surface.find(at, 0.3), exact);
    ASSERT_EQ(surface.find(at, 0.5), nearest.find(at, 0.5));
    const std::size_t about = surface.find_about(at, 0.5);
    if (exact == NearestPoint::kNone) continue;
    ++found;
    ASSERT_NE(about, NearestPoint::kNone);
    // Each of the two distances is off by half a cell's diagonal at most.
    EXPECT_LE((cloud.points_m[about] - at).norm(),
              (cloud.points_m[exact] - at).norm() + 0.1 * std::numbers::sqrt2 + 1e-12);
  }
  EXPECT_GT(found, 200);
  EXPECT_EQ(surface.find_about({50.0, 0.0}, 0.5), NearestPoint::kNone);
  EXPECT_EQ(surface.find_about({std::nan(""), 0.0}, 0.5), NearestPoint::kNone);
}

TEST(CloudMatcher, FindsThePoseOfASecondVisit) {
  RandomStream random(9, StreamId::kTest);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose2 first{random.normal(0.0, 0.2), random.normal(0.0, 0.2), random.uniform(-3.0, 3.0)};
    const Pose2 second{random.normal(0.0, 0.2), random.normal(0.0, 0.2), random.uniform(-3.0, 3.0)};
    const Pose2 truth = between(first, second);
    const Pose2 guess =
        truth * Pose2{random.normal(0.0, 0.1), random.normal(0.0, 0.1), random.normal(0.0, 0.1)};
    const PlaceMatch match =
        match_clouds(seen_from(7, first, 1), seen_from(7, second, 2), {{guess}}, {});
    ASSERT_TRUE(match.converged);
    EXPECT_LT(translation_distance(match.a_from_b, truth), 0.02);
    EXPECT_NEAR(angle_difference(match.a_from_b.theta, truth.theta), 0.0, 0.01);
    EXPECT_GT(match.gain, 20.0);
    EXPECT_GT(match.overlap, 0.9);
  }
}

TEST(CloudMatcher, GainsLessFromAnotherKindOfPlace) {
  const LocalCloud here = seen_from(7, {}, 1);
  const double same = match_clouds(here, seen_from(7, {}, 2), {{Pose2{}}}, {}).gain;
  const double other = match_clouds(here, seen_from(16 + 13, {}, 3), {{Pose2{}}}, {}).gain;
  EXPECT_GT(same, other + 20.0);
}

TEST(CloudMatcher, SaysThatACorridorFixesOnlyItsWidthAndHeading) {
  const LocalCloud corridor = seen_from(5, {}, 1);
  LocalCloud walls;  // the long walls only
  for (std::size_t i = 0; i < corridor.size(); ++i) {
    if (std::abs(corridor.normals[i].y()) < 0.9) continue;
    walls.points_m.push_back(corridor.points_m[i]);
    walls.normals.emplace_back(0.0, 1.0);
  }
  const PlaceMatch match = match_clouds(walls, walls, {{Pose2{}}}, {});
  ASSERT_TRUE(match.converged);
  EXPECT_NEAR(match.information(0, 0), 0.0, 1e-6);
  EXPECT_GT(match.information(1, 1), 1000.0);
  EXPECT_GT(match.information(2, 2), 100.0);
}

TEST(CloudMatcher, CountsAsManyPointsAsTheConfigSaysHoweverDense) {
  const LocalCloud sparse = seen_from(15, {}, 1);
  LocalCloud dense = sparse;
  for (int copy = 0; copy < 3; ++copy) {
    dense.points_m.insert(dense.points_m.end(), sparse.points_m.begin(), sparse.points_m.end());
    dense.normals.insert(dense.normals.end(), sparse.normals.begin(), sparse.normals.end());
  }
  const PlaceMatch one = match_clouds(sparse, sparse, {{Pose2{}}}, {});
  const PlaceMatch four = match_clouds(sparse, dense, {{Pose2{}}}, {});
  EXPECT_NEAR(one.gain, four.gain, 1e-6);
  EXPECT_TRUE(one.information.isApprox(four.information, 1e-6));
}

// With L the limit: exp(g) / (1 + exp(g - L)) is the likelihood of the same place against a mixture
// of another place that looks like none and, with weight exp(-L), one that looks the same.
TEST(CloudMatcher, SaysNoMoreThanThatAnotherPlaceMayLookTheSame) {
  CloudMatchConfig config;
  config.look_alike_gain = 3.0;
  for (const double gain : {-40.0, -5.0, 0.0, 2.9, 3.0, 3.1, 20.0}) {
    EXPECT_NEAR(gain_over_look_alikes(gain, config),
                std::log(std::exp(gain) / (1.0 + std::exp(gain - 3.0))), 1e-12);
  }
  EXPECT_NEAR(gain_over_look_alikes(1e6, config), 3.0, 1e-9);
  EXPECT_NEAR(gain_over_look_alikes(-1e6, config), -1e6, 1e-6);
}

TEST(CloudMatcher, FailsOpenlyWithoutPointsOrOverlap) {
  const LocalCloud here = seen_from(7, {}, 1);
  const CloudMatchConfig config;
  const PlaceMatch empty = match_clouds(here, {}, {{Pose2{}}}, config);
  EXPECT_FALSE(empty.converged);
  EXPECT_EQ(empty.gain, config.failure_gain);
  const PlaceMatch apart = match_clouds(here, here, {{Pose2{40.0, 0.0, 0.0}}}, config);
  EXPECT_FALSE(apart.converged);
  EXPECT_EQ(apart.gain, config.failure_gain);
  EXPECT_TRUE(apart.information.isZero());
}

}  // namespace
}  // namespace strata::topology
