// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose3.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata {
namespace {

Pose3 random_pose3(RandomStream& random) {
  return {{random.normal(), random.normal(), random.normal()},
          Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
              .normalized()};
}

TEST(Pose3, ObeysTheLawsOfAGroup) {
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 1'000; ++i) {
    const Pose3 a = random_pose3(random);
    const Pose3 b = random_pose3(random);
    const Eigen::Vector3d p(random.normal(), random.normal(), random.normal());
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    EXPECT_LT((inverse(a) * (a * p) - p).norm(), 1e-12);
  }
}

TEST(Pose3, LiftedPlanarPosesComposeAsInThePlane) {
  RandomStream random(2, StreamId::kTest);
  for (int i = 0; i < 1'000; ++i) {
    const Pose2 a{random.normal(), random.normal(), random.uniform(-3.0, 3.0)};
    const Pose2 b{random.normal(), random.normal(), random.uniform(-3.0, 3.0)};
    const Pose2 c = planar(lift(a) * lift(b));
    EXPECT_LT(translation_distance(c, a * b), 1e-12);
    EXPECT_NEAR(angle_difference(c.theta, (a * b).theta), 0.0, 1e-12);
  }
}

TEST(Pose3, KnowsASensorMountedUpsideDown) {
  Pose3 pose;
  EXPECT_FALSE(is_upside_down(pose));
  pose.rotation = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  EXPECT_TRUE(is_upside_down(pose));
  EXPECT_NEAR(heading_of(pose.rotation), 0.0, 1e-12);
}

}  // namespace
}  // namespace strata
