// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/descent.hpp"

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/topology/detail/quadratic.hpp"
#include "core/topology/detail/row_order.hpp"
#include "core/topology/detail/terms.hpp"
#include "tests/core/topology/reckoning.hpp"

namespace strata::topology {
namespace {

double& coordinate(Pose2& pose, int k) { return k == 0 ? pose.x : k == 1 ? pose.y : pose.theta; }

/// What f gives where one coordinate is a little larger less what it gives where it is smaller.
template <typename F>
auto derivative(std::vector<Pose2> poses, std::size_t visit, int k, const F& f) {
  constexpr double kStep = 1e-5;
  coordinate(poses[visit], k) += kStep;
  const auto above = f(poses);
  coordinate(poses[visit], k) -= 2.0 * kStep;
  const auto below = f(poses);
  return std::decay_t<decltype(f(poses))>(0.5 / kStep * (above - below));
}

TEST(Quadratic, HasTheGradientAndTheExactCurvatureOfTheCost) {
  LocationPriorConfig config;
  config.penalty_radius_m = 20.0;  // corners press on each other
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const test_world::Reckoning way = test_world::small_square(seed);
    const detail::Terms terms = detail::collect({0, 1, 2, 3, 0, 1, 2}, way.first(7), {}, config);
    std::vector<Pose2> poses = way.poses;
    poses[2].theta += 0.05;  // links are off
    detail::NearPairs near(terms.landmarks, config.penalty_radius_m);
    const std::vector<int> rows =
        detail::rows_after(nullptr, detail::touching(terms, config, poses, near), 7);
    const auto cost_of = [&](std::span<const Pose2> at) {
      return detail::cost_at(terms, at, config);
    };
    const auto gradient_of = [&](std::span<const Pose2> at) {
      return detail::gradient_at(terms, config, at, rows, near);
    };
    detail::Quadratic quadratic =
        detail::quadratic_at(terms, config, poses, rows, detail::Curvature::kExact, near);
    const Eigen::VectorXd gradient = quadratic.gradient();
    const auto factor = quadratic.factorize();
    ASSERT_NE(factor, nullptr) << seed;
    Eigen::MatrixXd curvature(18, 18);
    for (std::size_t visit = 1; visit < 7; ++visit) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Index at = 3 * static_cast<Eigen::Index>(rows[visit]) + k;
        EXPECT_NEAR(gradient[at], derivative(poses, visit, k, cost_of), 1e-4) << seed;
        curvature.col(at) = derivative(poses, visit, k, gradient_of);
      }
    }
    for (int row = 0; row < 6; ++row) {
      const Eigen::MatrixXd columns = curvature * factor->inverse_of(row);
      const Eigen::MatrixXd expected = Eigen::MatrixXd::Identity(18, 18).middleCols(3 * row, 3);
      EXPECT_LT((columns - expected).cwiseAbs().maxCoeff(), 1e-4) << seed;
    }
  }
}

// Newton's method goes a different way than Ceres, but to the same place, from every start.
TEST(Descent, ComesToRestWhereCeresDoes) {
  const LocationPriorConfig config;
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const test_world::Reckoning way = test_world::small_square(seed);
    for (const Labels& labels :
         {Labels{0, 1, 2, 3, 0, 1, 2}, Labels{0, 1, 2, 3, 4, 5, 6}, Labels{0, 1, 0, 2, 1, 0, 2}}) {
      const detail::Terms terms = detail::collect(labels, way.first(7), {}, config);
      std::vector<Pose2> slow = way.poses;
      double cost = 0.0;
      const bool found = detail::optimize(terms, config, slow, cost);
      if (!found) continue;
      const auto quick = detail::descend(terms, config, way.poses);
      ASSERT_TRUE(quick) << "seed " << seed;
      ++compared;
      EXPECT_NEAR(detail::cost_at(terms, slow, config), cost, 1e-9);
      EXPECT_NEAR(detail::cost_at(terms, quick->poses, config), quick->cost, 1e-4);
      EXPECT_LT(quick->cost, cost + 1e-3) << "seed " << seed;
      EXPECT_EQ(quick->gaussian->visits(), 7U);
    }
  }
  EXPECT_GT(compared, 50);
}

/// A third of the visits, taken for any landmark met before.
Labels folded(std::size_t visits, RandomStream& random) {
  Labels labels;
  int landmarks = 0;
  for (std::size_t i = 0; i < visits; ++i) {
    const bool is_known = i > 2 && random.uniform() < 1.0 / 3.0;
    labels.push_back(is_known ? static_cast<int>(random.uniform() * landmarks) : landmarks++);
  }
  return labels;
}

// Chains are bent far, and landmarks come to lie where they must not: the curvature is indefinite,
// and that of the Gaussian is off by far.
TEST(Descent, ComesToRestWhereTheWayIsFoldedAndLandmarksPressOnEachOther) {
  const LocationPriorConfig config;
  RandomStream random(1, StreamId::kTest, 82);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const test_world::Reckoning way(test_world::drive(
        test_world::rows_of_ten(40), test_world::row_by_row(40), kLandmarkOdometryNoise, seed));
    const std::size_t visits = way.poses.size();
    const detail::Terms terms =
        detail::collect(folded(visits, random), way.first(visits), {}, config);
    const auto optimum = detail::descend(terms, config, way.poses);
    ASSERT_TRUE(optimum) << seed;
    EXPECT_NEAR(detail::cost_at(terms, optimum->poses, config), optimum->cost, 1e-4) << seed;
    std::vector<Pose2> further = optimum->poses;
    double cost = 0.0;
    ASSERT_TRUE(detail::optimize(terms, config, further, cost)) << seed;
    EXPECT_GT(cost, optimum->cost - 1e-3) << seed;
  }
}

}  // namespace
}  // namespace strata::topology
