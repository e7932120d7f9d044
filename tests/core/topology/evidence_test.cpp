// SPDX-License-Identifier: Apache-2.0
#include "core/topology/evidence.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/topology/location_prior.hpp"
#include "core/topology/mapper_config.hpp"

namespace strata::topology {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

double log_gaussian(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  return -0.5 * (error.dot(covariance.inverse() * error) + std::log(covariance.determinant()) +
                 static_cast<double>(error.size()) * std::log(kTwoPi));
}

/// A chain of odometry, predicted poses, and densities of new landmarks.
struct Chain {
  std::vector<OdometryFactor> odometry;
  std::vector<double> densities;
  std::vector<Pose2> poses{Pose2{}};
  explicit Chain(const std::vector<Pose2>& steps) {
    densities.push_back(-std::log(kTwoPi * 900.0));
    for (const Pose2& step : steps) {
      odometry.push_back(odometry_step(step, step.translation().norm(), kLandmarkOdometryNoise));
      densities.push_back(-std::log(kTwoPi * 900.0));
      poses.push_back(poses.back() * step);
    }
  }
  [[nodiscard]] Measurements measurements() const { return {odometry, densities}; }
};

LocationPriorConfig without_penalty() {
  LocationPriorConfig config;
  config.max_penalty = 0.0;
  return config;
}

TEST(Evidence, OfNewLandmarksIsTheProductOfTheirDensities) {
  const Chain chain({{10.0, 0.0, 1.0}, {12.0, 1.0, -0.5}, {9.0, 0.0, 2.0}});
  const Evidence evidence =
      evaluate({0, 1, 2, 3}, chain.measurements(), {}, chain.poses, without_penalty());
  ASSERT_TRUE(evidence.converged);
  EXPECT_NEAR(evidence.log_evidence, -3.0 * std::log(kTwoPi * 900.0), 1e-6);
}

TEST(Evidence, OfARevisitIsTheGaussianThatOdometryAndPlaceMake) {
  const Chain chain({{0.6, -0.2, 3.0}});
  const LocationPriorConfig config;
  const Evidence evidence = evaluate({0, 0}, chain.measurements(), {}, chain.poses, config);
  ASSERT_TRUE(evidence.converged);
  const Eigen::Matrix2d covariance =
      chain.odometry[0].covariance.topLeftCorner<2, 2>() + 0.25 * Eigen::Matrix2d::Identity();
  const double expected = log_gaussian(chain.poses[1].translation(), covariance) - std::log(kTwoPi);
  EXPECT_NEAR(evidence.log_evidence, expected, 1e-6);
  EXPECT_LT(evidence.poses[1].translation().norm(), chain.poses[1].translation().norm());
}

/// Of a small floor and a large one.
TEST(Evidence, TakesADetectedPlaceForKnownWithinAMetreAndForNewBeyond) {
  const LocationPriorConfig config = detected_landmarks().location;
  for (const double area_m2 : {500.0, 4000.0}) {
    for (const double apart_m : {0.5, 0.85, 1.15, 1.4}) {
      const Pose2 step{apart_m, 0.0, 1.0};
      const OdometryFactor sure{step, 1e-6 * Eigen::Matrix3d::Identity()};
      const double density = -std::log(kTwoPi * area_m2);
      const std::vector<double> densities{density, density};
      const Measurements measured{{&sure, 1}, densities};
      const Evidence known = evaluate({0, 0}, measured, {}, {Pose2{}, step}, config);
      const Evidence fresh = evaluate({0, 1}, measured, {}, {Pose2{}, step}, config);
      ASSERT_TRUE(known.converged && fresh.converged);
      EXPECT_EQ(known.log_evidence > fresh.log_evidence, apart_m < 1.0)
          << apart_m << " m apart on " << area_m2 << " m^2";
    }
  }
}

TEST(Evidence, WithAScanFactorIsTheProductOfGaussians) {
  const Chain chain({{0.4, 0.1, 0.5}});
  PlaceMatch match;
  match.converged = true;
  match.a_from_b = {0.3, 0.2, 0.4};
  match.information = Eigen::Vector3d(400.0, 900.0, 2500.0).asDiagonal();
  match.gain = 12.0;
  const ScanFactor scan{0, 1, match};
  const Evidence evidence =
      evaluate({0, 0}, chain.measurements(), {{scan}}, chain.poses, LocationPriorConfig{});
  // Odometry, place and scan are Gaussians of one pose: complete the square.
  Eigen::Matrix3d odometry = chain.odometry[0].covariance.inverse();
  const Eigen::Matrix3d place = Eigen::Vector3d(4.0, 4.0, 0.0).asDiagonal();
  const Eigen::Matrix3d sum = odometry + place + match.information;
  const Eigen::Vector3d mean = sum.inverse() * (odometry * chain.poses[1].vector() +
                                                match.information * match.a_from_b.vector());
  const auto half_square = [](const Eigen::Vector3d& e, const Eigen::Matrix3d& information) {
    return 0.5 * e.dot(information * e);
  };
  const double cost = half_square(mean - chain.poses[1].vector(), odometry) +
                      half_square(mean, place) +
                      half_square(mean - match.a_from_b.vector(), match.information);
  const double constant = 12.0 - 1.5 * std::log(kTwoPi) + 0.5 * std::log(odometry.determinant()) -
                          2.0 * std::log(kTwoPi) - std::log(0.25);
  const double expected =
      constant - cost + 1.5 * std::log(kTwoPi) - 0.5 * std::log(sum.determinant());
  EXPECT_NEAR(evidence.log_evidence, expected, 1e-6);
  EXPECT_TRUE(marginal_covariances(*evidence.gaussian)[1].isApprox(sum.inverse(), 1e-6));
}

/// exp(-penalty) averaged over the Gaussian that odometry predicts, by brute force.
TEST(Evidence, WithPenaltyIsWithinATenthOfTheIntegral) {
  for (const double distance_m : {3.0, 6.0, 8.0}) {
    const Chain chain({{distance_m, 0.0, 0.3}});
    const LocationPriorConfig config;
    const Evidence evidence = evaluate({0, 1}, chain.measurements(), {}, chain.poses, config);
    ASSERT_TRUE(evidence.converged);
    RandomStream random(3, StreamId::kTest);
    const double sigma_m = std::sqrt(chain.odometry[0].covariance(0, 0));
    double mean = 0.0;
    constexpr int kDraws = 200'000;
    for (int i = 0; i < kDraws; ++i) {
      const double x = distance_m + random.normal(0.0, sigma_m);
      const double y = random.normal(0.0, sigma_m);
      mean += std::exp(-penalty_at(std::hypot(x, y), config).value) / kDraws;
    }
    EXPECT_NEAR(evidence.log_evidence, chain.densities[1] + std::log(mean), 0.1) << distance_m;
  }
}

TEST(Evidence, GivesCovariancesThatGrowAlongTheWayAndShrinkWhenALoopCloses) {
  const Chain chain({{10.0, 0.0, 1.57}, {10.0, 0.0, 1.57}, {10.0, 0.0, 1.57}, {10.0, 0.0, 1.57}});
  const Measurements measurements = chain.measurements();
  const Labels open{0, 1, 2, 3, 4};
  const Labels closed{0, 1, 2, 3, 0};
  const auto covariances = [&](const Labels& labels) {
    const Evidence evidence = evaluate(labels, measurements, {}, chain.poses, without_penalty());
    EXPECT_TRUE(evidence.converged);
    return marginal_covariances(*evidence.gaussian);
  };
  const auto before = covariances(open);
  const auto after = covariances(closed);
  EXPECT_TRUE(before[0].isZero());
  const auto spread = [](const Eigen::Matrix3d& covariance) {
    return covariance(0, 0) + covariance(1, 1);
  };
  EXPECT_LT(spread(before[1]), spread(before[2]));
  EXPECT_LT(spread(after[3]), spread(before[3]));
}

/// Rounds of nine visits, four of them known; the order is taken over from the visit before, or
/// looked for again.
TEST(Evidence, IsTheSameInTheOrderOfRowsOfTheVisitBefore) {
  std::vector<Pose2> steps;
  Labels labels{0};
  for (int i = 1; i < 60; ++i) {
    steps.push_back({6.0 + 0.1 * (i % 4), 0.05 * (i % 3), 0.7 + 0.002 * (i % 5)});
    labels.push_back(i % 9 < 4 && i > 9 ? labels[static_cast<std::size_t>(i) - 9] : 1000 + i);
  }
  labels = canonical(labels);
  const Chain chain(steps);
  const LocationPriorConfig config = without_penalty();
  Evidence before;
  std::vector<Pose2> start{Pose2{}};
  std::size_t other_rows = 0;
  for (std::size_t n = 2; n <= labels.size(); ++n) {
    const Labels first(labels.begin(), labels.begin() + static_cast<std::ptrdiff_t>(n));
    const Measurements measured{std::span(chain.odometry).first(n - 1),
                                std::span(chain.densities).first(n)};
    start.push_back(start.back() * steps[n - 2]);
    const Evidence alone = evaluate(first, measured, {}, start, config);
    Evidence after = evaluate(first, measured, {}, start, config, before.gaussian.get());
    ASSERT_TRUE(alone.converged && after.converged) << n;
    EXPECT_NEAR(after.log_evidence, alone.log_evidence, 1e-7) << n;
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_LT(translation_distance(after.poses[i], alone.poses[i]), 1e-8) << n;
    }
    other_rows += after.gaussian->rows() != alone.gaussian->rows() ? 1 : 0;
    start = after.poses;
    before = std::move(after);
  }
  EXPECT_GT(other_rows, 20U);
}

}  // namespace
}  // namespace strata::topology
