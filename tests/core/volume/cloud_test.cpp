// SPDX-License-Identifier: Apache-2.0
#include "core/volume/cloud.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/volume/camera.hpp"
#include "core/volume/dynamic_boxes.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume {
namespace {

Pose3 at(double x) {
  Pose3 pose;
  pose.translation = {x + 0.05, 0.05, 0.05};
  return pose;
}

/// Drives along x with 1 m/s, and looks at a wall at x = 5.05.
Cloud driven(std::vector<float>& offset_s) {
  Cloud cloud;
  cloud.stamp = Stamp::from_seconds(100.0);
  for (int i = 0; i < 10; ++i) {
    offset_s.push_back(0.2F * static_cast<float>((i * 7) % 10));
    cloud.points_m.push_back({5.0F - offset_s.back(), 0.0F, 0.0F});
    cloud.truly_moving.push_back(offset_s.back() > 1.0F ? 1 : 0);
  }
  return cloud;
}

TEST(Cloud, IsCutIntoPartsThatEachHaveThePoseOfTheirMiddle) {
  std::vector<float> offset_s;
  Cloud cloud = driven(offset_s);
  const auto poses = [](Stamp stamp) { return std::optional(at(stamp.seconds() - 100.0)); };
  EXPECT_EQ(cut_by_time(cloud, offset_s, 0.02, poses), 0U);
  ASSERT_EQ(cloud.parts.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(cloud.parts[i].begin, i);
    EXPECT_NEAR(cloud.parts[i].map_from_sensor.translation.x(), 0.05 + 0.2 * static_cast<double>(i),
                0.0201);
    EXPECT_NEAR(cloud.points_m[i].x(), 5.0 - 0.2 * static_cast<double>(i), 1e-5);
    EXPECT_EQ(cloud.truly_moving[i], i > 5 ? 1 : 0);
  }
  // In the map all points lie in the one voxel of the wall, and rays begin where the robot was.
  WorkerPool pool(2);
  VolumeMap map(VolumeConfig{});
  const CloudCounts counts = map.insert(cloud, {}, pool);
  EXPECT_EQ(counts.voxels_ended, 1U);
  EXPECT_EQ(counts.voxels_passed, 50U);
  EXPECT_GT(map.log_odds({5.05, 0.05, 0.05}).value(), 0.0F);
}

TEST(Cloud, LeavesOutPartsWithoutPose) {
  std::vector<float> offset_s;
  Cloud cloud = driven(offset_s);
  const auto poses = [](Stamp stamp) {
    return stamp.seconds() < 101.0 ? std::optional(at(0.0)) : std::nullopt;
  };
  EXPECT_EQ(cut_by_time(cloud, offset_s, 0.02, poses), 5U);
  EXPECT_EQ(cloud.points_m.size(), 5U);
  EXPECT_EQ(cloud.parts.size(), 5U);
}

TEST(Cloud, TakesAPointWithoutTimeForOneOfTheStamp) {
  Cloud cloud;
  cloud.points_m = {{1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}};
  const std::vector<float> offset_s{0.5F, std::numeric_limits<float>::quiet_NaN()};
  EXPECT_EQ(cut_by_time(cloud, offset_s, 0.1, [](Stamp) { return std::optional(at(0.0)); }), 0U);
  EXPECT_EQ(cloud.points_m[0].x(), 2.0F);
}

TEST(Cloud, TakesAPointOfDaysLaterForOneOfTheStamp) {
  Cloud cloud;
  cloud.points_m = {{1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}, {3.0F, 0.0F, 0.0F}};
  const std::vector<float> offset_s{0.5F, 1e30F, -1e30F};
  const auto poses = [](Stamp stamp) {
    const bool is_known = std::abs((stamp - Stamp()).seconds()) < 1.0;
    return is_known ? std::optional(at(0.0)) : std::nullopt;
  };
  EXPECT_EQ(cut_by_time(cloud, offset_s, 0.1, poses), 0U);
  ASSERT_EQ(cloud.parts.size(), 2U);
  EXPECT_EQ(cloud.points_m[0].x(), 2.0F);
  EXPECT_EQ(cloud.points_m[1].x(), 3.0F);
}

TEST(Cloud, MayHaveTenMillionPointsAndCountsThoseThatAreNoNumbers) {
  Cloud cloud;
  cloud.map_from_sensor = at(0.0);
  cloud.points_m.resize(10'000'000);
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
    const auto y = 0.001F * static_cast<float>(i % 500);
    cloud.points_m[i] = {0.5F, i % 1000 == 7 ? std::numeric_limits<float>::quiet_NaN() : y, 0.0F};
  }
  WorkerPool pool(2);
  VolumeMap map(VolumeConfig{});
  const CloudCounts counts = map.insert(cloud, {}, pool);
  EXPECT_EQ(counts.points, 10'000'000U);
  EXPECT_EQ(counts.not_finite, 10'000U);
  EXPECT_GE(counts.voxels_ended, 5U);
  EXPECT_GT(map.log_odds({0.55, 0.25, 0.05}).value(), 0.0F);
}

/// Someone walks along y with 1 m/s at x = 2, seen by a 2-D scanner.
DynamicBoxes walker() {
  std::vector<DynamicPoint> points;
  for (int i = 0; i < 80; ++i) {
    const double time_s = 0.05 * i;
    for (int k = 0; k < 3; ++k) {
      points.push_back({Stamp::from_seconds(time_s), {2.0, time_s - 0.05 + 0.05 * k}});
    }
  }
  return DynamicBoxes({}, std::move(points));
}

TEST(Cloud, ItsSweepWidensTheWindowOfBoxesByHalfOfIt) {
  Cloud cloud;
  cloud.stamp = Stamp::from_seconds(2.0);
  cloud.map_from_sensor.translation.z() = 1.0;
  cloud.points_m = {{2.0F, 2.0F, 0.0F}, {2.0F, 1.1F, 0.0F}, {2.0F, 2.9F, 0.0F}};
  EXPECT_EQ(walker().label(cloud), (std::vector<std::uint8_t>{1, 0, 0}));
  cloud.sweep_s = 2.0;
  EXPECT_EQ(walker().label(cloud), (std::vector<std::uint8_t>{1, 1, 1}));
  // Half a sweep and no more: 0.25 s + 0.25 s + margin and spread reach 1.2 and 2.8.
  cloud.sweep_s = 0.5;
  EXPECT_EQ(walker().label(cloud), (std::vector<std::uint8_t>{1, 0, 0}));
}

TEST(Cloud, ItsPartsAreJudgedAtTheirOwnMoments) {
  // Points where the walker is at that moment, and where he was or will be.
  Cloud cloud;
  cloud.stamp = Stamp::from_seconds(1.0);
  cloud.points_m = {{2.0F, 1.0F, 1.0F}, {2.0F, 3.0F, 1.0F}, {2.0F, 3.0F, 1.0F}, {2.0F, 1.0F, 1.0F}};
  const std::vector<float> offset_s{0.0F, 0.0F, 2.0F, 2.0F};
  cut_by_time(cloud, offset_s, 0.05, [](Stamp) { return std::optional(Pose3{}); });
  EXPECT_EQ(walker().label(cloud), (std::vector<std::uint8_t>{1, 0, 1, 0}));
}

Camera example_camera() { return {640, 480, 500.0, 510.0, 319.5, 239.5, {}}; }

TEST(Camera, ProjectsThroughThePinhole) {
  const auto pixel = project(example_camera(), {0.2, -0.1, 2.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 319.5 + 50.0, 1e-12);
  EXPECT_NEAR(pixel->y(), 239.5 - 25.5, 1e-12);
  EXPECT_FALSE(project(example_camera(), {0.2, -0.1, -2.0}));
  EXPECT_FALSE(project(example_camera(), {2.0, 0.0, 2.0}));
}

TEST(Camera, DistortsAsBrownAndConrady) {
  Camera camera = example_camera();
  camera.distortion = {-0.3, 0.1, 1e-3, -2e-3, 0.01};
  const double x = 0.2;
  const double y = -0.1;
  const double r2 = x * x + y * y;
  const double radial = 1.0 - 0.3 * r2 + 0.1 * r2 * r2 + 0.01 * r2 * r2 * r2;
  const double dx = x * radial + 2.0 * 1e-3 * x * y - 2e-3 * (r2 + 2.0 * x * x);
  const double dy = y * radial + 1e-3 * (r2 + 2.0 * y * y) - 2.0 * 2e-3 * x * y;
  const auto pixel = project(camera, {3.0 * x, 3.0 * y, 3.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 319.5 + 500.0 * dx, 1e-9);
  EXPECT_NEAR(pixel->y(), 239.5 + 510.0 * dy, 1e-9);
  // A barrel folds far points back into the picture: they are not there.
  camera.distortion = {-0.3};
  EXPECT_FALSE(project(camera, {2.2, 0.0, 1.2}));
}

}  // namespace
}  // namespace strata::volume
