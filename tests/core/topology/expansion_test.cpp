// SPDX-License-Identifier: Apache-2.0
#include "core/topology/expansion.hpp"

#include <gtest/gtest.h>

#include "core/topology/evidence.hpp"
#include "tests/core/topology/junction_world.hpp"

namespace strata::topology {
namespace {

/// A log whose visits lie where the odometry says, and see the walls of one crossing at the origin.
struct Seen {
  TopologyConfig config;
  VisitLog log;
  Hypothesis parent;  // of all visits but the last
  explicit Seen(const std::vector<Pose2>& poses) : log(config) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      LandmarkVisit visit;
      visit.stamp = {static_cast<std::int64_t>(i + 1) * 1'000'000'000};
      visit.odom_from_robot = poses[i];
      std::vector<Eigen::Vector2d> walls;
      for (const Eigen::Vector2d& point : test_world::wall_points({.kind = 15})) {
        walls.push_back(inverse(poses[i]) * point);
      }
      visit.cloud = with_normals(walls, 5);
      log.add(std::move(visit));
      if (i + 1 < poses.size()) parent.labels.push_back(static_cast<int>(i));
    }
    const std::vector<Pose2> before{poses.begin(), poses.end() - 1};
    const Evidence evidence =
        evaluate(parent.labels, log.measurements(before.size()), {}, before, config.location);
    parent.poses = evidence.poses;
    parent.log_evidence = evidence.log_evidence;
    parent.gaussian = evidence.gaussian;
  }
  [[nodiscard]] const OdometryFactor& last_way() const {
    return log.measurements(log.size()).odometry.back();
  }
};

/// The label wants the visit near its landmark, where the maps do not fit; the odometry does not.
TEST(Overlaps, ShowThatAPlaceIsDisplacedWhereTheLabelWouldNotHaveIt) {
  Seen seen({{0.0, 0.0, 0.0}, {2.5, 0.1, 0.0}});
  Children children;
  children.children.push_back({0, 0.0, 0.0, {Pose2{}, Pose2{0.1, 0.1, 0.0}}});
  const std::vector<Overlap> overlaps =
      find_overlaps(seen.parent, children, {2.5, 0.1, 0.0}, seen.log, seen.config.match);
  ASSERT_EQ(overlaps.size(), 1U);
  const PlaceMatch& match = overlaps[0].scan.match;
  EXPECT_TRUE(match.converged);
  EXPECT_GT(match.gain, 10.0);
  EXPECT_NEAR(match.a_from_b.x, 2.5, 0.1);
}

Overlap overlap_of(int label, std::size_t from, std::size_t to, const Pose2& at, double gain) {
  PlaceMatch match;
  match.converged = true;
  match.a_from_b = at;
  match.information = 1e3 * Eigen::Matrix3d::Identity();
  match.gain = gain;
  return {label, {from, to, match}};
}

TEST(CandidateEvidence, CountsThatItsOwnPlaceDoesNotFitThoughANeighboursMapDoes) {
  Seen seen({{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}, {0.8, 0.0, 0.0}});
  Prediction prediction(seen.parent.poses, *seen.parent.gaussian, seen.last_way());
  const Child child{0, 0.0, 0.0, {Pose2{}, Pose2{3.0, 0.0, 0.0}, Pose2{0.4, 0.0, 0.0}}};
  const auto evidence_with = [&](double own_gain) {
    const std::vector<Overlap> overlaps{overlap_of(0, 0, 2, {0.8, 0.0, 0.0}, own_gain),
                                        overlap_of(1, 1, 2, {-2.2, 0.0, 0.0}, 20.0)};
    return candidate_evidence(seen.parent, child, overlaps, prediction, seen.config, -9.0)
        .log_evidence;
  };
  EXPECT_NEAR(evidence_with(-3.0) - evidence_with(-8.0), 5.0, 1e-9);
  EXPECT_NEAR(evidence_with(1.0), evidence_with(2.0), 1e-9);  // one cloud is registered to, not two
}

}  // namespace
}  // namespace strata::topology
