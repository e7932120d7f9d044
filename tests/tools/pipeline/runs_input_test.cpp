// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/runs_input.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/carmen.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"

namespace strata::pipeline {
namespace {

using testing::ElementsAre;

log::StampedPose stamped(double time_s, const Pose2& pose) {
  return {Stamp::from_seconds(time_s), pose};
}

/// A second between the first two, then a gap that is a nanosecond too long.
std::vector<log::StampedPose> trajectory() {
  return {stamped(10.0, {0.0, 0.0, 3.0}),
          stamped(11.0, {2.0, -1.0, -3.0}),
          {Stamp{12'000'000'001}, {4.0, 0.0, 0.0}}};
}

Observation observed(int run, double time_s) {
  Observation observation;
  observation.run = run;
  observation.scan.stamp = Stamp::from_seconds(time_s);
  return observation;
}

TEST(PoseAt, InterpolatesTheShortWayRound) {
  const auto pose = pose_at(trajectory(), Stamp::from_seconds(10.25));
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->x, 0.5, 1e-12);
  EXPECT_NEAR(pose->y, -0.25, 1e-12);
  // From 3 rad to -3 rad lie 2 pi - 6 rad, across pi.
  EXPECT_NEAR(pose->theta, 3.0 + 0.25 * (2.0 * std::numbers::pi - 6.0), 1e-12);
}

TEST(PoseAt, GivesAnEntryWithinAMillisecondAsItIs) {
  const auto poses = trajectory();
  for (const double off_s : {-0.001, -0.0004, 0.0, 0.0004, 0.001}) {
    for (const log::StampedPose& entry : {poses[0], poses[1]}) {
      const auto pose = pose_at(poses, entry.stamp + Duration::from_seconds(off_s));
      ASSERT_TRUE(pose.has_value()) << off_s;
      EXPECT_EQ(*pose, entry.pose) << off_s;
    }
  }
}

TEST(PoseAt, KnowsNothingOutsideAndInGapsLongerThanASecond) {
  const auto poses = trajectory();
  EXPECT_FALSE(pose_at(poses, Stamp::from_seconds(9.99)).has_value());
  EXPECT_FALSE(pose_at(poses, Stamp::from_seconds(11.5)).has_value());
  EXPECT_FALSE(pose_at(poses, Stamp::from_seconds(12.01)).has_value());
  EXPECT_FALSE(pose_at({}, Stamp::from_seconds(10.0)).has_value());
}

TEST(ElapsedSeconds, AppendRunsWithoutTheTimeBetweenThem) {
  // The second run was recorded before the first by its stamps.
  const std::vector<Observation> observations{observed(0, 100.0), observed(0, 100.5),
                                              observed(0, 102.0), observed(1, 7.0),
                                              observed(1, 7.25),  observed(2, 7.25)};
  EXPECT_THAT(elapsed_seconds(observations), ElementsAre(0.0, 0.5, 2.0, 2.0, 2.25, 2.25));
  EXPECT_TRUE(elapsed_seconds({}).empty());
}

Observation driven(double x, double y) {
  Observation observation = observed(0, 1.0);
  observation.has_odometry = true;
  observation.odom_from_robot = {x, y, 0.5};
  return observation;
}

TEST(BringNear, MovesWhatBeginsFarFromTheOriginAndNothingElse) {
  log::ReadReport report;
  std::vector<Observation> near{driven(5e6, -3.0), driven(5e6 + 1.0, -2.0)};
  bring_near(near, "log", report);
  EXPECT_EQ(near[1].odom_from_robot, (Pose2{5e6 + 1.0, -2.0, 0.5}));
  EXPECT_TRUE(report.warnings.empty());
  std::vector<Observation> far{driven(1e9, -3.0), driven(1e9 + 1.0, -2.0)};
  bring_near(far, "log", report);
  EXPECT_EQ(far[0].odom_from_robot, (Pose2{0.0, 0.0, 0.5}));
  EXPECT_EQ(far[1].odom_from_robot, (Pose2{1.0, 1.0, 0.5}));
  EXPECT_EQ(report.warnings.size(), 1U);
}

TEST(BringNear, RefusesWhatLeadsFurtherThanAnyBuildingReaches) {
  log::ReadReport report;
  for (const double far_m : {1.1e5, 1e9, 1e300}) {
    std::vector<Observation> run{driven(0.0, 0.0), driven(1.0, 0.0), driven(far_m, 0.0)};
    try {
      bring_near(run, "log", report);
      FAIL() << far_m << " m were taken";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), "log: scan 3");
    }
    for (Observation& observation : run) observation.has_odometry = false;
    EXPECT_NO_THROW(bring_near(run, "log", report));
  }
}

TEST(ReadRuns, WantsOnePoseFileALogOrNone) {
  RunsInput too_few_poses;
  too_few_poses.logs = {"a.clf", "b.clf"};
  too_few_poses.poses = {"a.tum"};
  EXPECT_THROW(static_cast<void>(read_runs(too_few_poses, nullptr)), InputError);
  RunsInput too_many_truths;
  too_many_truths.logs = {"a.clf"};
  too_many_truths.truths = {"a.tum", "b.tum"};
  EXPECT_THROW(static_cast<void>(read_runs(too_many_truths, nullptr)), InputError);
}

TEST(ReadRuns, FindsThePoseOfEveryScanAndRefusesATruthOfAnotherTime) {
  const test::TemporaryDirectory dir;
  const Runs simulated = test_room::simulate_runs(1, 1);
  const std::string log = (dir.path() / "day.clf").string();
  const std::string truth = (dir.path() / "truth.tum").string();
  log::LogContent content;
  content.observations = simulated.observations;
  log::write_carmen(log, content);
  constexpr double kShift_s = 100000.0;
  std::vector<log::StampedPose> poses;
  for (std::size_t i = 0; i < simulated.observations.size(); ++i) {
    const Stamp stamp = simulated.observations[i].scan.stamp;
    poses.push_back({stamp + Duration::from_seconds(kShift_s), *simulated.truths[i]});
  }
  log::write_trajectory(truth, poses);

  RunsInput input;
  input.logs = {log};
  input.truths = {truth};
  EXPECT_THROW(static_cast<void>(read_runs(input, nullptr)), InputError);
  input.truth_offset_s = -kShift_s;
  const Runs runs = read_runs(input, nullptr, 4);
  ASSERT_EQ(runs.observations.size(), simulated.observations.size());
  ASSERT_EQ(runs.truths.size(), runs.observations.size());
  ASSERT_EQ(runs.poses.size(), runs.observations.size());
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    EXPECT_EQ(runs.observations[i].run, 4);
    EXPECT_EQ(runs.observations[i].scan.ranges_m, simulated.observations[i].scan.ranges_m);
    EXPECT_FALSE(runs.poses[i].has_value());
    ASSERT_TRUE(runs.truths[i].has_value());
    EXPECT_LT(translation_distance(*runs.truths[i], *simulated.truths[i]), 1e-6);
  }
}

}  // namespace
}  // namespace strata::pipeline
