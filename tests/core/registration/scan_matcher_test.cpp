// SPDX-License-Identifier: Apache-2.0
#include "core/registration/scan_matcher.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "tests/core/registration/ceres_solver.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::registration {
namespace {

/// Points every 2 cm along the walls, with the walls' true normals.
MatchField field_of(const std::vector<test::Wall>& walls, double slack_m = 0.0) {
  MatchField field(0.05);
  for (const test::Wall& wall : walls) {
    const double length = std::hypot(wall.x1 - wall.x0, wall.y1 - wall.y0);
    const int steps = static_cast<int>(std::ceil(length / 0.02));
    for (int i = 0; i <= steps; ++i) {
      SurfacePoint point;
      point.x_m = wall.x0 + (wall.x1 - wall.x0) * i / steps;
      point.y_m = wall.y0 + (wall.y1 - wall.y0) * i / steps;
      point.normal_x = (wall.y1 - wall.y0) / length;
      point.normal_y = -(wall.x1 - wall.x0) / length;
      point.tangential = 0.02;
      point.slack_m = slack_m;
      field.add(point);
    }
  }
  return field;
}

Pose2 random_pose_in_room(RandomStream& random) {
  return {random.uniform(3.0, 7.0), random.uniform(1.0, 5.0), random.uniform(-3.1, 3.1)};
}

Pose2 near(const Pose2& pose, RandomStream& random, double metres, double radians) {
  return {pose.x + random.uniform(-metres, metres), pose.y + random.uniform(-metres, metres),
          wrap_angle(pose.theta + random.uniform(-radians, radians))};
}

TEST(ScanMatcher, JacobianOfABeamEqualsFiniteDifferences) {
  const MatchField field = field_of(test::room(), 0.004);
  RandomStream random(3, StreamId::kTest);
  int checked = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose2 p = random_pose_in_room(random);
    const double pose[3] = {p.x, p.y, p.theta};
    const double x = random.uniform(-4.0, 4.0);
    const double y = random.uniform(-4.0, 4.0);
    double residual[2];
    double jacobian[6];
    if (!beam_residual(x, y, field, pose, 0.05, residual, jacobian)) continue;
    const Eigen::Vector2d at = p * Eigen::Vector2d(x, y);
    const SurfacePoint* surface = field.nearest(at.x(), at.y());
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 3; ++k) {
      double plus[3] = {pose[0], pose[1], pose[2]};
      double minus[3] = {pose[0], pose[1], pose[2]};
      plus[k] += kStep;
      minus[k] -= kStep;
      double r_plus[2];
      double r_minus[2];
      const Eigen::Vector2d at_plus = Pose2{plus[0], plus[1], plus[2]} * Eigen::Vector2d(x, y);
      const Eigen::Vector2d at_minus = Pose2{minus[0], minus[1], minus[2]} * Eigen::Vector2d(x, y);
      // The nearest surface is held fixed in the derivative.
      if (field.nearest(at_plus.x(), at_plus.y()) != surface) continue;
      if (field.nearest(at_minus.x(), at_minus.y()) != surface) continue;
      ASSERT_TRUE(beam_residual(x, y, field, plus, 0.05, r_plus, nullptr));
      ASSERT_TRUE(beam_residual(x, y, field, minus, 0.05, r_minus, nullptr));
      for (int r = 0; r < 2; ++r) {
        ASSERT_NEAR(jacobian[3 * r + k], (r_plus[r] - r_minus[r]) / (2.0 * kStep),
                    1e-5 * (1.0 + std::abs(jacobian[3 * r + k])));
      }
      ++checked;
    }
  }
  EXPECT_GT(checked, 500);
}

TEST(ScanMatcher, GradientEqualsFiniteDifferencesOfTheCost) {
  const MatchField field = field_of(test::room(), 0.004);
  RandomStream random(4, StreamId::kTest);
  int checked = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose2 truth = random_pose_in_room(random);
    const Endpoints hits =
        subsample(endpoints_in_robot(test::scan_of(test::room(), truth, 0.0)), 20);
    const Pose2 pose = near(truth, random, 0.1, 0.03);
    const Pose2Gaussian prior{truth, Eigen::Vector3d(0.01, 0.02, 0.001).asDiagonal()};
    const MatchCost at = evaluate_match(hits, {}, field, pose, &prior, 0.1, 0.95);
    const auto cost = [&](double dx, double dy, double dt) {
      return evaluate_match(hits, {}, field, {pose.x + dx, pose.y + dy, pose.theta + dt}, &prior,
                            0.1, 0.95)
          .cost;
    };
    constexpr double kStep = 1e-7;
    const Eigen::Vector3d numeric = Eigen::Vector3d(cost(kStep, 0, 0) - cost(-kStep, 0, 0),
                                                    cost(0, kStep, 0) - cost(0, -kStep, 0),
                                                    cost(0, 0, kStep) - cost(0, 0, -kStep)) /
                                    (2.0 * kStep);
    // A beam that changes its surface within the step makes a jump; leave such poses out.
    if ((numeric - at.gradient).norm() > 1e3) continue;
    ASSERT_LT((numeric - at.gradient).norm(), 1e-3 * (1.0 + at.gradient.norm()));
    ++checked;
  }
  EXPECT_GT(checked, 55);
}

TEST(ScanMatcher, FindsThePoseOfExactScansFromPosesAQuarterMetreOff) {
  const MatchField field = field_of(test::room());
  RandomStream random(5, StreamId::kTest);
  for (int i = 0; i < 100; ++i) {
    const Pose2 truth = random_pose_in_room(random);
    const Endpoints hits = endpoints_in_robot(test::scan_of(test::room(), truth, 0.0));
    const MatchResult result = match(hits, {}, field, near(truth, random, 0.15, 0.08), nullptr);
    ASSERT_TRUE(result.converged) << i;
    ASSERT_LT(translation_distance(result.pose, truth), 0.005) << i;
    ASSERT_LT(std::abs(angle_difference(result.pose.theta, truth.theta)), 0.002) << i;
    ASSERT_GT(result.inlier_share, 0.95);
  }
}

TEST(ScanMatcher, CeresAndTheDirectSolverFindTheSameMinimum) {
  const MatchField field = field_of(test::room(), 0.004);
  RandomStream random(6, StreamId::kTest);
  const MatchConfig config;
  for (int i = 0; i < 30; ++i) {
    const Pose2 truth = random_pose_in_room(random);
    const Endpoints hits =
        endpoints_in_robot(test::scan_of(test::room(), truth, static_cast<double>(i), 0.01));
    const Pose2 guess = near(truth, random, 0.1, 0.05);
    const Pose2Gaussian prior{guess, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()};
    const MatchResult direct = match(hits, {}, field, guess, &prior, config);
    const Pose2 by_ceres = match_with_ceres(hits, field, guess, prior, config);
    const double cost =
        evaluate_match(hits, {}, field, by_ceres, &prior, config.hit_stddev_m, config.hit_weight)
            .cost;
    ASSERT_LT(translation_distance(direct.pose, by_ceres), 1e-3) << i;
    ASSERT_NEAR(direct.pose.theta, by_ceres.theta, 1e-3) << i;
    ASSERT_NEAR(direct.cost, cost, 0.05 + 1e-3 * direct.cost) << i;
  }
}

TEST(ScanMatcher, CostAtThePoseIsNeverAboveTheCostAtTheGuess) {
  const MatchField field = field_of(test::room());
  RandomStream random(8, StreamId::kTest);
  const MatchConfig config;
  for (int i = 0; i < 100; ++i) {
    const Pose2 truth = random_pose_in_room(random);
    const Endpoints hits = endpoints_in_robot(test::scan_of(test::room(), truth, 0.0));
    const Pose2 guess = near(truth, random, 1.0, 1.0);
    const MatchResult result = match(hits, {}, field, guess, nullptr, config);
    const double before =
        evaluate_match(hits, {}, field, guess, nullptr, config.hit_stddev_m, config.hit_weight)
            .cost;
    ASSERT_LE(result.cost, before + 1e-9);
  }
}

TEST(ScanMatcher, BeamsHeldToBeDynamicDoNotPull) {
  const MatchField field = field_of(test::room());
  const Pose2 truth{5.5, 3.0, 0.4};
  Scan scan = test::scan_of(test::room(), truth, 0.0);
  std::vector<float> weights(scan.size(), 1.0F);
  for (std::size_t i = 0; i < scan.size(); i += 2) {
    scan.ranges_m[i] -= 0.12F;  // something stands a little before the wall everywhere
    weights[i] = 0.0F;
  }
  const Endpoints hits = endpoints_in_robot(scan);
  const MatchResult weighted = match(hits, weights, field, {5.55, 3.05, 0.42}, nullptr);
  const MatchResult plain = match(hits, {}, field, {5.55, 3.05, 0.42}, nullptr);
  EXPECT_LT(translation_distance(weighted.pose, truth), 0.005);
  EXPECT_GT(weighted.inlier_share, plain.inlier_share + 0.2);
}

TEST(ScanMatcher, ABareCorridorConvergesOnlyWithAPriorAndIsUncertainAlongItself) {
  const std::vector<test::Wall> corridor{{-40.0, 1.0, 40.0, 1.0}, {40.0, -1.0, -40.0, -1.0}};
  const MatchField field = field_of(corridor);
  const Endpoints hits = endpoints_in_robot(
      test::scan_of(corridor, {0.0, 0.2, 0.05}, 0.0, 0.0, 1, 180, std::numbers::pi, 8.0));
  const MatchResult free = match(hits, {}, field, {0.0, 0.1, 0.0}, nullptr);
  EXPECT_NEAR(free.pose.y, 0.2, 0.01);
  EXPECT_GT(free.covariance(0, 0), 20.0 * free.covariance(1, 1));
  const Pose2Gaussian prior{{0.3, 0.1, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()};
  const MatchResult held = match(hits, {}, field, prior.mean, &prior);
  EXPECT_TRUE(held.converged);
  EXPECT_NEAR(held.pose.x, 0.3, 0.05);
  EXPECT_NEAR(held.pose.y, 0.2, 0.01);
}

TEST(ScanMatcher, WithoutHitsOrFarFromTheMapItHasNotConverged) {
  const MatchField field = field_of(test::room());
  const Pose2 guess{1.0, 2.0, 0.5};
  const Pose2Gaussian prior{guess, Eigen::Vector3d(0.1, 0.2, 0.3).asDiagonal()};
  const MatchResult empty = match({}, {}, field, guess, &prior);
  EXPECT_FALSE(empty.converged);
  EXPECT_EQ(empty.pose, guess);
  EXPECT_DOUBLE_EQ(empty.covariance(1, 1), 0.2);
  const Endpoints hits = endpoints_in_robot(test::scan_of(test::room(), {5.0, 3.0, 0.0}, 0.0));
  const MatchResult lost = match(hits, {}, field, {500.0, 500.0, 0.0}, nullptr);
  EXPECT_FALSE(lost.converged);
}

}  // namespace
}  // namespace strata::registration
