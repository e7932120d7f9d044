// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose2_gaussian.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata {
namespace {

Pose2Gaussian small_gaussian(RandomStream& random) {
  Eigen::Matrix3d root;
  for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = random.normal(0.0, 0.01);
  return {{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)},
          root * root.transpose() + 1e-6 * Eigen::Matrix3d::Identity()};
}

Pose2 draw(const Pose2Gaussian& gaussian, RandomStream& random) {
  const Eigen::Matrix3d root = gaussian.covariance.llt().matrixL();
  const Eigen::Vector3d z(random.normal(), random.normal(), random.normal());
  const Eigen::Vector3d d = root * z;
  return {gaussian.mean.x + d.x(), gaussian.mean.y + d.y(), gaussian.mean.theta + d.z()};
}

/// Mean and covariance of 20,000 outcomes equal to the first-order result within sampling noise.
template <typename Outcome>
void expect_monte_carlo(const Pose2Gaussian& expected, Outcome&& outcome) {
  constexpr std::size_t kDraws = 20'000;
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < kDraws; ++i) poses.push_back(outcome());
  const Pose2Gaussian sampled = weighted_gaussian(poses, std::vector<double>(kDraws, 1.0));
  EXPECT_LT(translation_distance(sampled.mean, expected.mean), 0.005);
  EXPECT_NEAR(angle_difference(sampled.mean.theta, expected.mean.theta), 0.0, 0.001);
  // The standard error of a covariance is about sqrt(2/n) = 1% of its diagonal.
  const double scale = expected.covariance.norm();
  EXPECT_LT((sampled.covariance - expected.covariance).norm(), 0.06 * scale);
}

TEST(Pose2Gaussian, CompositionHasTheCovarianceOfSampledCompositions) {
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 5; ++i) {
    const Pose2Gaussian a = small_gaussian(random);
    const Pose2Gaussian b = small_gaussian(random);
    expect_monte_carlo(a * b, [&] { return draw(a, random) * draw(b, random); });
  }
}

TEST(Pose2Gaussian, InverseHasTheCovarianceOfSampledInverses) {
  RandomStream random(2, StreamId::kTest);
  for (int i = 0; i < 5; ++i) {
    const Pose2Gaussian a = small_gaussian(random);
    expect_monte_carlo(inverse(a), [&] { return inverse(draw(a, random)); });
  }
}

TEST(Pose2Gaussian, TwiceInvertedIsItselfAgain) {
  RandomStream random(3, StreamId::kTest);
  const Pose2Gaussian a = small_gaussian(random);
  const Pose2Gaussian b = inverse(inverse(a));
  EXPECT_LT(translation_distance(a.mean, b.mean), 1e-12);
  EXPECT_LT((a.covariance - b.covariance).norm(), 1e-12);
}

TEST(MahalanobisSquared, CountsStandardDeviationsAcrossTheSeamOfTheCircle) {
  Pose2Gaussian gaussian;
  gaussian.mean = {1.0, 2.0, 3.1};
  gaussian.covariance = Eigen::Vector3d(0.04, 0.09, 0.01).asDiagonal();
  EXPECT_NEAR(mahalanobis_squared(gaussian, {1.2, 2.0, 3.1}), 1.0, 1e-12);
  EXPECT_NEAR(mahalanobis_squared(gaussian, {1.0, 2.6, 3.1}), 4.0, 1e-12);
  EXPECT_NEAR(mahalanobis_squared(gaussian, {1.0, 2.0, wrap_angle(3.3)}), 4.0, 1e-9);
}

TEST(WeightedGaussian, AveragesHeadingsAcrossTheSeamOfTheCircle) {
  const std::vector<Pose2> poses{{0.0, 0.0, 3.1}, {2.0, 0.0, -3.1}};
  const std::vector<double> weights{2.0, 2.0};
  const Pose2Gaussian result = weighted_gaussian(poses, weights);
  EXPECT_NEAR(result.mean.x, 1.0, 1e-15);
  EXPECT_NEAR(std::abs(result.mean.theta), std::numbers::pi, 1e-12);
  EXPECT_NEAR(result.covariance(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(result.covariance(2, 2), std::pow(std::numbers::pi - 3.1, 2), 1e-12);
}

TEST(WeightedGaussian, IgnoresPosesWithoutWeight) {
  const std::vector<Pose2> poses{{1.0, 1.0, 1.0}, {100.0, 100.0, -1.0}};
  const std::vector<double> weights{3.0, 0.0};
  const Pose2Gaussian result = weighted_gaussian(poses, weights);
  EXPECT_NEAR(result.mean.x, 1.0, 1e-12);
  EXPECT_LT(result.covariance.norm(), 1e-20);
}

}  // namespace
}  // namespace strata
