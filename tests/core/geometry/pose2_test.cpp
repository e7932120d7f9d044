// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose2.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata {
namespace {

Pose2 random_pose(RandomStream& random) {
  return {random.uniform(-10.0, 10.0), random.uniform(-10.0, 10.0),
          random.uniform(-std::numbers::pi, std::numbers::pi)};
}

void expect_near(const Pose2& a, const Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(angle_difference(a.theta, b.theta), 0.0, tolerance);
}

TEST(Pose2, ObeysTheLawsOfAGroup) {
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 1'000; ++i) {
    const Pose2 a = random_pose(random);
    const Pose2 b = random_pose(random);
    const Pose2 c = random_pose(random);
    expect_near((a * b) * c, a * (b * c), 1e-12);
    expect_near(a * inverse(a), Pose2{}, 1e-12);
    expect_near(inverse(a) * a, Pose2{}, 1e-12);
    expect_near(Pose2{} * a, a, 1e-15);
    expect_near(between(a, b), inverse(a) * b, 1e-12);
    expect_near(a * between(a, b), b, 1e-12);
  }
}

TEST(Pose2, MovesPointsAsTheComposedPoseDoes) {
  RandomStream random(2, StreamId::kTest);
  for (int i = 0; i < 1'000; ++i) {
    const Pose2 a = random_pose(random);
    const Pose2 b = random_pose(random);
    const Eigen::Vector2d p(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    EXPECT_NEAR((a * p - a.translation()).norm(), p.norm(), 1e-12);
  }
  const Eigen::Vector2d ahead = Pose2{1.0, 2.0, std::numbers::pi / 2.0} * Eigen::Vector2d(3.0, 0.0);
  EXPECT_LT((ahead - Eigen::Vector2d(1.0, 5.0)).norm(), 1e-15);
}

TEST(Pose2, ComposeJacobiansEqualFiniteDifferences) {
  RandomStream random(3, StreamId::kTest);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Pose2 a = random_pose(random);
    const Pose2 b = random_pose(random);
    const Eigen::Matrix3d left = compose_jacobian_left(a, b);
    const Eigen::Matrix3d right = compose_jacobian_right(a, b);
    for (int k = 0; k < 3; ++k) {
      auto moved = [k](const Pose2& pose, double by) {
        return Pose2{pose.x + (k == 0 ? by : 0.0), pose.y + (k == 1 ? by : 0.0),
                     pose.theta + (k == 2 ? by : 0.0)};
      };
      auto slope = [](const Pose2& high, const Pose2& low) -> Eigen::Vector3d {
        return Eigen::Vector3d(high.x - low.x, high.y - low.y,
                               angle_difference(high.theta, low.theta)) /
               (2.0 * kStep);
      };
      EXPECT_LT((left.col(k) - slope(moved(a, kStep) * b, moved(a, -kStep) * b)).norm(), 1e-7);
      EXPECT_LT((right.col(k) - slope(a * moved(b, kStep), a * moved(b, -kStep))).norm(), 1e-7);
    }
  }
}

TEST(Interpolate, MeetsBothEndsAndTurnsTheShortWay) {
  const Pose2 a{0.0, 0.0, 3.0};
  const Pose2 b{2.0, 4.0, -3.0};
  expect_near(interpolate(a, b, 0.0), a, 1e-15);
  expect_near(interpolate(a, b, 1.0), b, 1e-15);
  expect_near(interpolate(a, b, 0.5), {1.0, 2.0, std::numbers::pi}, 1e-12);
}

TEST(Align, RecoversTheMotionBetweenTwoTrajectories) {
  RandomStream random(4, StreamId::kTest);
  for (int i = 0; i < 200; ++i) {
    const Pose2 motion = random_pose(random);
    std::vector<Pose2> source;
    std::vector<Pose2> target;
    for (int k = 0; k < 5; ++k) {
      source.push_back(random_pose(random));
      target.push_back(motion * source.back());
    }
    expect_near(align(source, target), motion, 1e-11);
  }
}

TEST(Align, LeavesNoBetterMotionNearby) {
  RandomStream random(5, StreamId::kTest);
  std::vector<Pose2> source;
  std::vector<Pose2> target;
  for (int k = 0; k < 30; ++k) {
    source.push_back(random_pose(random));
    target.push_back(Pose2{1.0, -2.0, 0.7} * source.back());
    target.back().x += random.normal(0.0, 0.3);
    target.back().y += random.normal(0.0, 0.3);
  }
  auto cost = [&](const Pose2& motion) {
    double sum = 0.0;
    for (std::size_t k = 0; k < source.size(); ++k) {
      sum += (motion * source[k].translation() - target[k].translation()).squaredNorm();
    }
    return sum;
  };
  const Pose2 best = align(source, target);
  for (const double d : {-1e-3, 1e-3}) {
    EXPECT_LT(cost(best), cost({best.x + d, best.y, best.theta}));
    EXPECT_LT(cost(best), cost({best.x, best.y + d, best.theta}));
    EXPECT_LT(cost(best), cost({best.x, best.y, best.theta + d}));
  }
}

TEST(Align, TakesTheHeadingOfASinglePose) {
  const std::vector<Pose2> source{{1.0, 2.0, 0.3}};
  const std::vector<Pose2> target{{-4.0, 0.0, 1.5}};
  expect_near(align(source, target) * source[0], target[0], 1e-12);
}

TEST(IsFinite, SpotsEachBrokenNumber) {
  EXPECT_TRUE(is_finite({1.0, 2.0, 3.0}));
  EXPECT_FALSE(is_finite({std::nan(""), 0.0, 0.0}));
  EXPECT_FALSE(is_finite({0.0, INFINITY, 0.0}));
  EXPECT_FALSE(is_finite({0.0, 0.0, -INFINITY}));
}

}  // namespace
}  // namespace strata
