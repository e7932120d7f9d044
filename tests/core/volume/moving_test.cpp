// SPDX-License-Identifier: Apache-2.0
/// What is taken for moving, and slices.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/volume/dynamic_boxes.hpp"
#include "core/volume/slice.hpp"
#include "core/volume/volume_map.hpp"
#include "core/volume/voxel_filter.hpp"

namespace strata::volume {
namespace {

Cloud cloud_with(const std::vector<Eigen::Vector3f>& points) {
  Cloud cloud;
  cloud.map_from_sensor.translation = {0.05, 0.05, 0.05};
  cloud.points_m = points;
  return cloud;
}

VoxelFilter filter_with(double prior, double static_clouds = 0.0) {
  return {{.prior = prior, .static_clouds = static_clouds}, VoxelLattice(0.1), RayLimits{}};
}

VoxelKey key_at(const Eigen::Vector3f& point) { return VoxelLattice(0.1).key_at(point).value(); }

TEST(VoxelFilter, MaximizesTheLikelihoodOfWhatEndedAndWhatPassed) {
  for (const double p : {0.77, 0.9}) {
    VoxelFilter filter = filter_with(p);
    WorkerPool pool(2);
    const int ended = 3;
    const int passed = 7;
    for (int i = 0; i < ended; ++i) filter.count(cloud_with({{1.0F, 0.0F, 0.0F}}), pool);
    for (int i = 0; i < passed; ++i) filter.count(cloud_with({{3.0F, 0.0F, 0.0F}}), pool);
    double best_m = 0.0;
    double best = -std::numeric_limits<double>::infinity();
    for (double m = 0.0; m < 1.0; m += 1e-5) {
      const double l =
          ended * std::log((1.0 - p) + (2.0 * p - 1.0) * m) + passed * std::log(1.0 - m);
      if (l > best) {
        best = l;
        best_m = m;
      }
    }
    const double expected = p * best_m / (p * best_m + (1.0 - p) * (1.0 - best_m));
    EXPECT_NEAR(filter.static_probability(key_at({1.05F, 0.05F, 0.05F})), expected, 1e-3) << p;
  }
}

TEST(VoxelFilter, LabelsWhatWasPassedMostOfTheTime) {
  VoxelFilter filter = filter_with(0.77);
  WorkerPool pool(2);
  const Cloud person = cloud_with({{1.0F, 0.0F, 0.0F}, {0.0F, 2.0F, 0.0F}});
  const Cloud wall = cloud_with({{3.0F, 0.0F, 0.0F}, {0.0F, 2.0F, 0.0F}});
  filter.count(person, pool);
  for (int i = 0; i < 4; ++i) filter.count(wall, pool);
  EXPECT_EQ(filter.label(person, pool), (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(filter.label(wall, pool), (std::vector<std::uint8_t>{0, 0}));
}

TEST(VoxelFilter, NeedsMoreCloudsThatPassedWhereFewLooked) {
  WorkerPool pool(1);
  const Cloud person = cloud_with({{1.0F, 0.0F, 0.0F}});
  const Cloud wall = cloud_with({{3.0F, 0.0F, 0.0F}});
  // p = 0.6: moving below 80% of looks, three of them given.
  VoxelFilter filter = filter_with(0.6, 3.0);
  filter.count(person, pool);
  filter.count(person, pool);
  filter.count(wall, pool);
  EXPECT_EQ(filter.label(person, pool).front(), 0);  // 5 of 6
  filter.count(wall, pool);
  EXPECT_EQ(filter.label(person, pool).front(), 1);  // 5 of 7
}

TEST(VoxelFilter, CountsNothingInTheTailOfARayThatComesInFlat) {
  VoxelFilter filter = filter_with(0.77);
  WorkerPool pool(1);
  // From 1 m above a floor at z = 0: noise lifts the floor into the voxels above it once.
  const Eigen::Vector3f lifted(5.0F, 0.0F, -0.99F);
  Cloud cloud = cloud_with({lifted});
  cloud.map_from_sensor.translation = {0.05, 0.05, 1.05};
  filter.count(cloud, pool);
  // Later rays reach the floor 0.4 m behind, and run just above it before.
  cloud.points_m = {{5.4F, 0.0F, -1.05F}};
  for (int i = 0; i < 9; ++i) filter.count(cloud, pool);
  cloud.points_m = {lifted};
  EXPECT_EQ(filter.label(cloud, pool).front(), 0);
  // A person's knee there is passed by rays to the wall behind.
  cloud.points_m = {{5.0F, 0.0F, -0.6F}};
  filter.count(cloud, pool);
  cloud.points_m = {{8.0F, 0.0F, -0.96F}};
  for (int i = 0; i < 9; ++i) filter.count(cloud, pool);
  cloud.points_m = {{5.0F, 0.0F, -0.6F}};
  EXPECT_EQ(filter.label(cloud, pool).front(), 1);
}

TEST(VoxelFilter, DoesNotCountWhatIsPassedBesideAnEndOfTheSameCloud) {
  VoxelFilter filter = filter_with(0.77);
  WorkerPool pool(1);
  filter.count(cloud_with({{1.0F, 0.0F, 0.0F}}), pool);
  // Passes the voxel above and below ends beside it.
  for (int i = 0; i < 9; ++i) {
    filter.count(cloud_with({{3.0F, 0.0F, 0.0F}, {1.0F, 0.0F, -0.1F}}), pool);
  }
  EXPECT_GT(filter.static_probability(key_at({1.05F, 0.05F, 0.05F})), 0.9);
}

/// An upright wall through (4, 0, 0) of the sensor, along a direction of the plane.
std::vector<Eigen::Vector3f> wall_along(double yaw_rad) {
  std::vector<Eigen::Vector3f> points;
  for (int along = -6; along <= 6; ++along) {
    for (int up = -6; up <= 6; ++up) {
      points.emplace_back(4.0 + 0.1 * along * std::cos(yaw_rad), 0.1 * along * std::sin(yaw_rad),
                          0.1 * up);
    }
  }
  return points;
}

TEST(VoxelFilter, CountsLittleOfCloudsThatLookAlongASurface) {
  WorkerPool pool(1);
  const VoxelKey middle = key_at({4.05F, 0.05F, 0.05F});
  for (const double yaw_rad : {0.0, 0.5 * std::numbers::pi, 0.7, -0.7, 2.0}) {
    const Eigen::Vector3f along(std::cos(yaw_rad), std::sin(yaw_rad), 0.0F);
    const Eigen::Vector3f across(-along.y(), along.x(), 0.0F);
    const auto probability_when_passed = [&](const Eigen::Vector3f& way) {
      VoxelFilter filter = filter_with(0.77);
      for (int i = 0; i < 2; ++i) filter.count(cloud_with(wall_along(yaw_rad)), pool);
      Cloud passing = cloud_with({10.0F * way});
      passing.map_from_sensor.translation =
          (Eigen::Vector3f(4.05F, 0.05F, 0.05F) - 3.0F * way).cast<double>();
      for (int i = 0; i < 4; ++i) filter.count(passing, pool);
      return filter.static_probability(middle);
    };
    EXPECT_LT(probability_when_passed(across), 0.5) << yaw_rad;
    EXPECT_GT(probability_when_passed(along), 0.9) << yaw_rad;
    EXPECT_LT(probability_when_passed((across + 0.3F * along).normalized()), 0.5) << yaw_rad;
  }
}

TEST(VoxelFilter, KeepsTheShareOfWhatItSawThousandsOfTimes) {
  WorkerPool pool(1);
  VoxelFilter filter = filter_with(0.9);
  for (int i = 0; i < 3000; ++i) {
    filter.count(cloud_with({{i % 3 == 0 ? 1.0F : 3.0F, 0.0F, 0.0F}}), pool);
  }
  VoxelFilter of_three = filter_with(0.9);
  for (const float x : {1.0F, 3.0F, 3.0F}) of_three.count(cloud_with({{x, 0.0F, 0.0F}}), pool);
  const VoxelKey key = key_at({1.05F, 0.05F, 0.05F});
  EXPECT_GT(of_three.static_probability(key), 0.1);
  EXPECT_NEAR(filter.static_probability(key), of_three.static_probability(key), 0.01);
}

TEST(VoxelFilter, KnowsNothingOfWhatItDidNotSee) {
  EXPECT_EQ(filter_with(0.9).static_probability({1, 2, 3}), 0.9);
  EXPECT_THROW(filter_with(0.4), ConfigError);
}

DynamicPoint point(double s, double x, double y) { return {Stamp::from_seconds(s), {x, y}}; }

TEST(DynamicBoxes, HoldTheClustersOfTheirMoment) {
  const DynamicBoxes boxes({}, {point(0.0, 9.0, 9.0), point(1.0, 0.0, 0.0), point(1.0, 0.2, 0.0),
                                point(1.1, 0.2, 0.25), point(1.1, 5.0, 5.0), point(1.2, 5.1, 5.0)});
  const auto found = boxes.at(Stamp::from_seconds(1.1));
  ASSERT_EQ(found.size(), 1U);  // two points at (5, 5) are too few
  EXPECT_TRUE(found[0].low_m.isApprox(Eigen::Vector2d(-0.25, -0.25)));
  EXPECT_TRUE(found[0].high_m.isApprox(Eigen::Vector2d(0.45, 0.5)));
  EXPECT_TRUE(boxes.at(Stamp::from_seconds(2.0)).empty());
}

TEST(DynamicBoxes, LabelPointsBetweenFloorAndHead) {
  const DynamicBoxes boxes({}, {point(1.0, 2.0, 0.0), point(1.0, 2.1, 0.0), point(1.0, 2.2, 0.0)});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Cloud cloud = cloud_with({{2.0F, 0.0F, 1.0F},
                            {2.0F, 0.0F, 2.5F},
                            {2.0F, 0.0F, -0.05F},
                            {3.0F, 0.0F, 1.0F},
                            {nan, 0.0F, 0.0F}});
  cloud.stamp = Stamp::from_seconds(1.2);
  EXPECT_EQ(boxes.label(cloud), (std::vector<std::uint8_t>{1, 0, 0, 0, 0}));
}

TEST(DynamicPoints, AreTheEndsOfHitsThatAreHardlyStatic) {
  PosedScan scan;
  scan.map_from_robot = {1.0, 2.0, 0.0};
  scan.scan.angle_increment_rad = 0.5F;
  scan.scan.range_max_m = 10.0F;
  scan.scan.ranges_m = {3.0F, 3.0F, std::numeric_limits<float>::infinity()};
  scan.static_probability = {0.1F, 0.9F, 0.1F};
  const auto points = dynamic_points(std::vector<PosedScan>{scan});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_TRUE(points[0].place_m.isApprox(Eigen::Vector2d(4.0, 2.0)));
}

TEST(Slice, SaysWhatStandsBetweenTwoHeights) {
  VolumeMap map(VolumeConfig{});
  WorkerPool pool(1);
  map.insert(cloud_with({{1.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}), {}, pool);
  const ReflectionGrid low = slice(map, 0.0, 0.1);
  EXPECT_EQ(low.get({10, 0}), 1.0F);
  EXPECT_EQ(low.get({9, 0}), 0.0F);
  EXPECT_EQ(low.get({0, 0}), 0.0F);
  EXPECT_FALSE(is_known(low.get({11, 0})));
  EXPECT_EQ(slice(map, 0.0, 2.0).get({0, 0}), 1.0F);
  EXPECT_TRUE(slice(map, 7.0, 8.0).rect().empty());
}

}  // namespace
}  // namespace strata::volume
