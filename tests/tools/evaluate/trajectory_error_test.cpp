// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluate/trajectory_error.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "tests/support/test_data.hpp"

namespace strata::tools {
namespace {

using log::Relation;
using log::StampedPose;

std::vector<StampedPose> curve() {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.1 * i;
    poses.push_back({Stamp::from_seconds(t),
                     {2.0 * std::cos(0.3 * t), std::sin(0.5 * t), wrap_angle(0.4 * t)}});
  }
  return poses;
}

TEST(Summary, KnowsItsClosedForms) {
  const ErrorSummary summary = summarize({4.0, 1.0, 3.0, 2.0});
  EXPECT_DOUBLE_EQ(summary.mean, 2.5);
  EXPECT_DOUBLE_EQ(summary.median, 2.5);
  EXPECT_DOUBLE_EQ(summary.max, 4.0);
  EXPECT_DOUBLE_EQ(summary.p95, 4.0);
  EXPECT_DOUBLE_EQ(summary.mean_squared, 7.5);
  EXPECT_DOUBLE_EQ(summary.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(summary.stddev, std::sqrt(1.25));
  EXPECT_EQ(summarize({}).max, 0.0);
}

TEST(TrajectoryError, AMovedFrameIsAnAbsoluteErrorAndNoOther) {
  const auto truth = curve();
  const Pose2 offset{3.0, -4.0, 1.0};
  auto moved = truth;
  for (StampedPose& pose : moved) pose.pose = offset * pose.pose;
  EXPECT_GT(absolute_errors(moved, truth, Pose2{}).translation_m.mean, 1.0);
  const Pose2 motion = alignment(moved, truth);
  EXPECT_LT(absolute_errors(moved, truth, motion).translation_m.max, 1e-9);
  EXPECT_LT(absolute_errors(moved, truth, motion).rotation_rad.max, 1e-9);
  EXPECT_LT(relative_errors(moved, truth, 1.0).translation_m.max, 1e-9);
  const Pose2 back = motion * offset;
  EXPECT_NEAR(back.x, 0.0, 1e-9);
  EXPECT_NEAR(back.theta, 0.0, 1e-9);
}

TEST(TrajectoryError, AShiftAlongTheWayHasItsSize) {
  const auto truth = curve();
  auto shifted = truth;
  for (StampedPose& pose : shifted) pose.pose.x += 0.25;
  const TrajectoryErrors errors = absolute_errors(shifted, truth, Pose2{});
  EXPECT_EQ(errors.matched, truth.size());
  EXPECT_NEAR(errors.translation_m.mean, 0.25, 1e-12);
  EXPECT_NEAR(errors.translation_m.p95, 0.25, 1e-12);
  EXPECT_NEAR(errors.rotation_rad.max, 0.0, 1e-12);
}

TEST(TrajectoryError, PosesBetweenStampsAreInterpolatedAndGapsAreNotBridged) {
  const std::vector<StampedPose> poses = {
      {{0}, {0, 0, 0}}, {Stamp::from_seconds(0.4), {4, 0, 0}}, {Stamp::from_seconds(9), {5, 0, 0}}};
  EXPECT_NEAR(pose_at(poses, Stamp::from_seconds(0.1))->x, 1.0, 1e-9);
  EXPECT_EQ(pose_at(poses, Stamp::from_seconds(0.4000001))->x, 4.0);
  EXPECT_FALSE(pose_at(poses, Stamp::from_seconds(5)).has_value());
  EXPECT_FALSE(pose_at(poses, Stamp::from_seconds(-1)).has_value());
  EXPECT_FALSE(pose_at(poses, Stamp::from_seconds(9.1)).has_value());
}

TEST(RelationError, ComparesMotionsNotPoses) {
  auto poses = curve();
  std::vector<Relation> relations;
  for (std::size_t i = 0; i + 10 < poses.size(); i += 5) {
    relations.push_back(
        {poses[i].stamp, poses[i + 10].stamp, between(poses[i].pose, poses[i + 10].pose)});
  }
  for (StampedPose& pose : poses) pose.pose = Pose2{10, 20, 2} * pose.pose;
  EXPECT_LT(relation_errors(poses, relations).translation_m.max, 1e-9);
  for (Relation& relation : relations) {
    relation.first_from_second = relation.first_from_second * Pose2{0.03, 0.04, 0.01};
  }
  const TrajectoryErrors errors = relation_errors(poses, relations);
  EXPECT_NEAR(errors.translation_m.mean, 0.05, 1e-6);
  EXPECT_NEAR(errors.translation_m.mean_squared, 0.0025, 1e-6);
  EXPECT_NEAR(errors.rotation_rad.mean, 0.01, 1e-9);
  relations.push_back({Stamp::from_seconds(100), Stamp::from_seconds(101), {}});
  EXPECT_EQ(relation_errors(poses, relations).unmatched, 1U);
}

TEST(RelationError, PairedTellsWhichOfTwoTrajectoriesIsBetterAndWhenNeitherIsShownToBe) {
  std::vector<StampedPose> truth;
  std::vector<StampedPose> other;  // as good: worse in one minute, better in the next
  std::vector<StampedPose> worse;
  std::vector<Relation> relations;
  for (int i = 0; i <= 1200; ++i) {
    const Stamp stamp = Stamp::from_seconds(i);
    truth.push_back({stamp, {0.1 * i, 0.0, 0.0}});
    other.push_back({stamp, {0.1 * i, 0.01 * i, 0.0}});
    worse.push_back({stamp, {0.1 * i, i % 2 == 0 ? 0.0 : 0.03, 0.0}});
    if (i > 0) {
      const double off = (i / 60) % 2 == 0 ? 0.0 : 0.01;
      relations.push_back({truth[static_cast<std::size_t>(i) - 1].stamp, stamp, {0.1, off, 0.0}});
    }
  }
  const PairedErrors clear = paired_relation_errors(worse, truth, relations);
  EXPECT_EQ(clear.matched, 1200U);
  EXPECT_NEAR(clear.mean_difference_m, 0.025, 1e-3);
  EXPECT_GT(clear.difference_m.low, 0.02);
  const PairedErrors unclear = paired_relation_errors(other, truth, relations);
  EXPECT_LT(unclear.difference_m.low, 0.0);
  EXPECT_GT(unclear.difference_m.high, 0.0);
  EXPECT_EQ(paired_relation_errors(truth, truth, relations).mean_difference_m, 0.0);
  EXPECT_EQ(paired_relation_errors({}, truth, relations).matched, 0U);
}

TEST(RelationError, ReferencesOfRealLogsAreAsFarFromTheirRelationsAsPublishedWithThem) {
  STRATA_REQUIRE_DATA(reference, "intel/intel.ref_scanmatched.txt");
  STRATA_REQUIRE_DATA(relations, "intel/intel.relations");
  const auto errors =
      relation_errors(log::read_trajectory(reference), log::read_relations(relations));
  EXPECT_EQ(errors.unmatched, 0U);
  EXPECT_NEAR(errors.translation_m.mean, 0.024, 0.001);
  STRATA_REQUIRE_DATA(fr079, "fr079/fr079.ref_scanmatched.txt");
  STRATA_REQUIRE_DATA(fr079_relations, "fr079/fr079.relations");
  auto poses = log::read_trajectory(fr079);
  const auto wanted = log::read_relations(fr079_relations);
  EXPECT_NEAR(relation_errors(poses, wanted).translation_m.mean, 0.045, 0.001);
  for (StampedPose& pose : poses) pose.pose = pose.pose * Pose2{0.04, 0.0, 0.0};
  EXPECT_NEAR(relation_errors(poses, wanted).translation_m.mean, 0.037, 0.001);
}

}  // namespace
}  // namespace strata::tools
