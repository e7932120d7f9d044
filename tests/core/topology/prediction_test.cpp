// SPDX-License-Identifier: Apache-2.0
#include "core/topology/prediction.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/core/topology/reckoning.hpp"

namespace strata::topology {
namespace {

PlaceMatch some_match(const Pose2& a_from_b) {
  PlaceMatch match;
  match.converged = true;
  match.a_from_b = a_from_b;
  match.information = Eigen::Vector3d(900.0, 0.0, 400.0).asDiagonal();  // a corridor
  return match;
}

TEST(Prediction, OfARevisitIsWithinANatOfTheOptimizedEvidence) {
  LocationPriorConfig config;
  config.max_penalty = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const test_world::Reckoning way = test_world::small_square(seed);
    const Labels before{0, 1, 2, 3};
    const Evidence four =
        evaluate(before, way.first(4), {}, {way.poses.begin(), way.poses.begin() + 4}, config);
    ASSERT_TRUE(four.converged);
    Prediction prediction(four.poses, *four.gaussian, way.odometry[3]);
    const LinearizedFactor place = prediction.same_place_factor(0, config);
    const PlaceMatch match = some_match(between(way.poses[0], prediction.newest()));
    for (const bool with_scan : {false, true}) {
      std::vector<LinearizedFactor> factors{place};
      std::vector<ScanFactor> scans;
      if (with_scan) {
        factors.push_back(prediction.registration_factor(0, match));
        scans.push_back({0, 4, match});
      }
      const Prediction::Conditioned conditioned = prediction.conditioned_on(factors);
      const double linear = four.log_evidence + conditioned.log_factor -
                            2.0 * std::log(2.0 * std::numbers::pi * config.revisit_stddev_m);
      const Evidence exact =
          evaluate({0, 1, 2, 3, 0}, way.first(5), scans, conditioned.poses, config);
      ASSERT_TRUE(exact.converged);
      EXPECT_NEAR(linear, exact.log_evidence, 1.0) << "seed " << seed << ' ' << with_scan;
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_LT(translation_distance(conditioned.poses[i], exact.poses[i]), 0.3);
      }
    }
  }
}

TEST(Prediction, IsExactWhereEverythingIsLinear) {
  LocationPriorConfig config;
  // One pose beside the fixed first one, headings known to be equal: nothing bends.
  const OdometryFactor odometry{{0.7, -0.4, 0.0}, Eigen::Vector3d(0.2, 0.3, 0.1).asDiagonal()};
  const std::vector<Pose2> poses{Pose2{}};
  const LocationGaussian certain;
  Prediction prediction(poses, certain, odometry);
  const LinearizedFactor place = prediction.same_place_factor(0, config);
  const Eigen::Matrix2d covariance =
      odometry.covariance.topLeftCorner<2, 2>() + 0.25 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d apart(0.7, -0.4);
  const double expected = -0.5 * apart.dot(covariance.inverse() * apart) -
                          0.5 * std::log(covariance.determinant()) - std::log(4.0);
  EXPECT_NEAR(prediction.conditioned_on({&place, 1}).log_factor, expected, 1e-12);
  EXPECT_TRUE(prediction.covariance_apart(0).isApprox(odometry.covariance.topLeftCorner<2, 2>()));
}

TEST(LocationGaussian, GivesTheInverseOfItsInformation) {
  const test_world::Reckoning way = test_world::small_square(3);
  const LocationPriorConfig config;
  const Evidence evidence = evaluate({0, 1, 2, 3, 0, 1, 2}, way.first(7), {}, way.poses, config);
  ASSERT_TRUE(evidence.converged);
  Eigen::MatrixXd covariance(21, 21);
  for (std::size_t i = 0; i < 7; ++i) {
    covariance.middleCols<3>(3 * static_cast<Eigen::Index>(i)) =
        evidence.gaussian->covariance_with(i);
  }
  EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-9));
  const std::vector<std::pair<std::size_t, Eigen::Vector3d>> forces{
      {0, {9.0, 9.0, 9.0}}, {2, {1.0, -2.0, 0.5}}, {6, {0.3, 0.0, 4.0}}, {2, {0.0, 0.1, 0.0}}};
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(21);
  for (const auto& [visit, force] : forces) {
    expected += covariance.middleCols<3>(3 * static_cast<Eigen::Index>(visit)) * force;
  }
  EXPECT_TRUE(evidence.gaussian->moved_by(forces).isApprox(expected, 1e-9));
  const Eigen::MatrixXd free = covariance.bottomRightCorner(18, 18);
  EXPECT_NEAR(-std::log(free.determinant()), evidence.gaussian->log_determinant(), 1e-6);
  EXPECT_TRUE(covariance.topRows<3>().isZero());
}

}  // namespace
}  // namespace strata::topology
