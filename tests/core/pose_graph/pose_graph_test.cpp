// SPDX-License-Identifier: Apache-2.0
#include "core/pose_graph/pose_graph.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata::pose_graph {
namespace {

Pose2 random_pose(RandomStream& random) {
  return {random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), random.uniform(-3.1, 3.1)};
}

Eigen::Matrix3d information(double metres, double radians) {
  return Eigen::Vector3d(1.0 / (metres * metres), 1.0 / (metres * metres),
                         1.0 / (radians * radians))
      .asDiagonal();
}

TEST(PoseGraph, JacobiansEqualFiniteDifferences) {
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 200; ++i) {
    const Pose2 a = random_pose(random);
    const Pose2 b = random_pose(random);
    const Pose2 z = between(a, b) * Pose2{0.1, -0.2, 0.3};
    Eigen::Matrix3d by_a;
    Eigen::Matrix3d by_b;
    ASSERT_NEAR(edge_error(a, b, z, &by_a, &by_b).z(), -0.3, 1e-9);
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d step = Eigen::Vector3d::Zero();
      step(k) = kStep;
      const auto moved = [&](const Pose2& p, double sign) {
        return Pose2{p.x + sign * step.x(), p.y + sign * step.y(), p.theta + sign * step.z()};
      };
      const Eigen::Vector3d numeric_a =
          (edge_error(moved(a, 1.0), b, z) - edge_error(moved(a, -1.0), b, z)) / (2.0 * kStep);
      const Eigen::Vector3d numeric_b =
          (edge_error(a, moved(b, 1.0), z) - edge_error(a, moved(b, -1.0), z)) / (2.0 * kStep);
      ASSERT_LT((numeric_a - by_a.col(k)).norm(), 1e-6);
      ASSERT_LT((numeric_b - by_b.col(k)).norm(), 1e-6);
    }
  }
}

TEST(PoseGraph, AnOpenChainBecomesTheProductOfItsEdges) {
  RandomStream random(2, StreamId::kTest);
  PoseGraph graph;
  Pose2 expected = random_pose(random);
  std::vector<Pose2> chain{expected};
  graph.add_node(expected);
  for (int i = 0; i < 30; ++i) {
    const Pose2 step{random.uniform(0.2, 1.0), random.uniform(-0.1, 0.1),
                     random.uniform(-0.5, 0.5)};
    expected = expected * step;
    chain.push_back(expected);
    graph.add_node(expected * Pose2{0.1, -0.1, 0.05});  // a poor first estimate
    graph.add_edge({static_cast<std::size_t>(i), static_cast<std::size_t>(i) + 1, step,
                    information(0.1, 0.02)});
  }
  const PoseGraphResult result = graph.optimize();
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.final_cost, 0.0, 1e-8);
  for (std::size_t i = 0; i < chain.size(); ++i) {
    ASSERT_LT(translation_distance(graph.pose(i), chain[i]), 1e-4);
    ASSERT_NEAR(angle_difference(graph.pose(i).theta, chain[i].theta), 0.0, 1e-4);
  }
}

TEST(PoseGraph, ALoopSharesItsErrorEquallyAmongEqualEdges) {
  // Five steps of 1 m straight on, and one edge that says the last node lies at 5.6 m; headings
  // held by tight information, so the problem is linear: each of the six edges takes 0.1 m.
  PoseGraph graph;
  for (int i = 0; i <= 5; ++i) graph.add_node({static_cast<double>(i), 0.0, 0.0});
  for (std::size_t i = 0; i < 5; ++i) {
    graph.add_edge({i, i + 1, {1.0, 0.0, 0.0}, information(0.1, 1e-4)});
  }
  graph.add_edge({0, 5, {5.6, 0.0, 0.0}, information(0.1, 1e-4)});
  EXPECT_TRUE(graph.optimize().converged);
  for (std::size_t i = 0; i <= 5; ++i) {
    EXPECT_NEAR(graph.pose(i).x, 1.1 * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(graph.pose(i).y, 0.0, 1e-9);
  }
  EXPECT_NEAR(graph.squared_error(0), 1.0, 1e-4);
  EXPECT_NEAR(graph.squared_error(5), 1.0, 1e-4);
}

TEST(PoseGraph, ANoisyCircleIsPulledTogetherByItsClosure) {
  RandomStream random(3, StreamId::kTest);
  PoseGraph open;
  PoseGraph closed;
  const Pose2 step{1.0, 0.0, 2.0 * std::numbers::pi / 40.0};
  Pose2 truth;
  Pose2 drifting;
  std::vector<Pose2> truths;
  for (std::size_t i = 0; i <= 40; ++i) {
    truths.push_back(truth);
    if (i == 0) open.add_node(drifting);
    if (i == 0) closed.add_node(drifting);
    if (i == 40) break;
    const Pose2 measured{step.x + random.normal(0.0, 0.02), random.normal(0.0, 0.02),
                         step.theta + random.normal(0.0, 0.02)};
    open.add_node({});
    closed.add_node({});
    open.add_edge({i, i + 1, measured, information(0.02, 0.02)});
    closed.add_edge({i, i + 1, measured, information(0.02, 0.02)});
    truth = truth * step;
    drifting = drifting * measured;
    open.set_pose(i + 1, drifting);
    closed.set_pose(i + 1, drifting);
  }
  closed.add_edge({40, 0, {}, information(0.01, 0.005), true});
  open.optimize();
  EXPECT_TRUE(closed.optimize().converged);
  EXPECT_GT(translation_distance(open.pose(40), truths[40]), 0.2);
  EXPECT_LT(translation_distance(closed.pose(40), truths[40]), 0.05);
}

TEST(PoseGraph, AFalseRobustClosureHardlyMovesTheRest) {
  PoseGraph graph;
  for (int i = 0; i <= 10; ++i) graph.add_node({static_cast<double>(i), 0.0, 0.0});
  for (std::size_t i = 0; i < 10; ++i) {
    graph.add_edge({i, i + 1, {1.0, 0.0, 0.0}, information(0.05, 0.01)});
  }
  graph.add_edge({0, 10, {10.0, 0.0, 0.0}, information(0.05, 0.01), true});
  const std::size_t wrong = graph.add_edge({2, 8, {0.0, 3.0, 1.0}, information(0.05, 0.01), true});
  graph.optimize();
  EXPECT_GT(graph.squared_error(wrong), 1000.0);
  graph.disable_edge(wrong);
  EXPECT_TRUE(graph.optimize().converged);
  for (std::size_t i = 0; i <= 10; ++i) {
    EXPECT_LT(translation_distance(graph.pose(i), {static_cast<double>(i), 0.0, 0.0}), 1e-4);
  }
}

TEST(PoseGraph, HoldsFixedNodesAndTheFirstOfEveryPartWithoutAnAnchor) {
  PoseGraph graph;
  graph.add_node({1.0, 2.0, 0.1});
  graph.add_node({5.0, 5.0, 0.0});
  graph.add_node({9.0, 9.0, 0.0}, true);
  graph.add_node({8.0, 9.0, 0.0});
  graph.add_edge({0, 1, {1.0, 0.0, 0.0}, information(0.1, 0.1)});
  graph.add_edge({2, 3, {1.0, 0.0, 0.0}, information(0.1, 0.1)});
  EXPECT_TRUE(graph.optimize().converged);
  EXPECT_EQ(graph.pose(0), (Pose2{1.0, 2.0, 0.1}));
  EXPECT_EQ(graph.pose(2), (Pose2{9.0, 9.0, 0.0}));
  EXPECT_LT(translation_distance(graph.pose(3), {10.0, 9.0, 0.0}), 1e-5);
}

TEST(PoseGraph, APriorAndAnEdgeMeetInTheMiddle) {
  PoseGraph graph;
  graph.add_node({0.0, 0.0, 0.0}, true);
  graph.add_node({1.0, 0.0, 0.0});
  graph.add_edge({0, 1, {1.0, 0.0, 0.0}, information(0.1, 0.01)});
  graph.add_prior({1, {2.0, 0.0, 0.0}, information(0.1, 0.01)});
  EXPECT_TRUE(graph.optimize().converged);
  EXPECT_NEAR(graph.pose(1).x, 1.5, 1e-6);
}

TEST(PoseGraph, RejectsEdgesThatMakeNoSense) {
  PoseGraph graph;
  graph.add_node({});
  graph.add_node({});
  EXPECT_THROW(graph.add_edge({0, 0, {}, information(1.0, 1.0)}), InputError);
  EXPECT_THROW(graph.add_edge({0, 2, {}, information(1.0, 1.0)}), InputError);
  EXPECT_THROW(graph.add_edge({0, 1, {}, Eigen::Matrix3d::Zero()}), InputError);
  EXPECT_THROW(graph.add_prior({7, {}, information(1.0, 1.0)}), InputError);
  EXPECT_TRUE(graph.optimize().converged);
}

}  // namespace
}  // namespace strata::pose_graph
