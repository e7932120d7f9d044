// SPDX-License-Identifier: Apache-2.0
#include "components/topology_mapper/topology_mapper.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/topologies/topology_messages.hpp"
#include "memory/store/store.hpp"
#include "tests/components/topology_mapper/mapped_robot.hpp"
#include "tests/support/test_data.hpp"

namespace strata::topology_mapper {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using test::kStepM;
using test::kStepS;
using test::Moment;
using test::scan_at;
using test::there_and_back;

void expect_sound(const Topologies& message) {
  const std::vector<topology::TopologySummary> topologies = convert::from_message(message);
  double sum = 0.0;
  for (const topology::TopologySummary& summary : topologies) {
    sum += summary.probability;
    EXPECT_LE(summary.probability, topologies.front().probability);
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);  // fewer than fifty, so none is left out
}

// Times at which the robot passes x = 3 m and 9 m, there and back.
constexpr double kThere3 = 1.0 + 5 * kStepS;
constexpr double kThere9 = 1.0 + 35 * kStepS;
constexpr double kBack9 = 1.0 + (58 + 15) * kStepS;
constexpr double kBack3 = 1.0 + (58 + 45) * kStepS;

TEST(TopologyMapper, TellsAfterEachLandmarkWhichPlacesAreTheSameAndLateJoinersToo) {
  const test::TemporaryDirectory folder;
  const auto saved = folder.path() / "saved";
  Robot robot("mapping: {landmarks: {source: given}}, published_topologies: 50, save: '" +
              saved.string() + "'");
  for (const double time_s : {kThere3, kThere9, kBack9, kBack3}) robot.mark(time_s);
  ASSERT_TRUE(robot.says("received /landmark", "4"));
  robot.drive(there_and_back());
  const auto first = robot.wait_for(3);
  ASSERT_EQ(first.size(), 3U);  // around the fourth the robot has not gone on far enough
  for (std::size_t i = 0; i < 3; ++i) {
    expect_sound(first[i]);
    EXPECT_EQ(first[i].visits().size(), i + 1);
    EXPECT_EQ(first[i].header().frame_id(), "map");
  }
  EXPECT_EQ(robot.seen_by_a_late_joiner().back(), first.back());
  robot.end();
  const auto all = robot.wait_for(4);
  ASSERT_EQ(all.size(), 4U);
  expect_sound(all[3]);
  const topology::TopologySummary likeliest = convert::from_message(all[3]).front();
  EXPECT_EQ(likeliest.labels, (topology::Labels{0, 1, 1, 0}));
  EXPECT_GT(likeliest.probability, 0.8);
  EXPECT_LT((likeliest.landmarks[1].mean.translation() - Eigen::Vector2d(9.0, 2.0)).norm(), 0.1);
  for (const char* file :
       {"topologies.json", "topology.graphml", "occupancy.yaml", "trajectory.tum"}) {
    EXPECT_TRUE(std::filesystem::exists(saved / file)) << file;
  }
}

TEST(TopologyMapper, GoesOnFromItsStoreWithTheLandmarksOfBefore) {
  const test::TemporaryDirectory folder;
  const std::string parameters =
      "mapping: {landmarks: {source: given}}, published_topologies: 50, "
      "store: {file: '" +
      (folder.path() / "way.db").string() + "'}";
  const std::vector<Moment> drive = there_and_back();
  const auto turn = drive.begin() + 55;  // at the far end, two landmarks behind it
  std::vector<Topologies> before;
  {
    Robot robot(parameters);
    for (const double time_s : {kThere3, kThere9}) robot.mark(time_s);
    ASSERT_TRUE(robot.says("received /landmark", "2"));
    robot.drive({drive.begin(), turn});
    before = robot.wait_for(2);
    ASSERT_EQ(before.size(), 2U);
    ASSERT_TRUE(robot.says("received /scan", "55"));
    robot.end();
  }
  Robot robot(parameters);
  const auto known = robot.seen_by_a_late_joiner();
  ASSERT_EQ(known.size(), 1U) << "told before anything comes";
  EXPECT_EQ(known.back().visits(), before.back().visits());
  EXPECT_EQ(convert::from_message(known.back()).front().labels, (topology::Labels{0, 1}));
  for (const double time_s : {kBack9, kBack3}) robot.mark(time_s);
  ASSERT_TRUE(robot.says("received /landmark", "2"));
  robot.drive({turn + 2, drive.end()});  // it was away for two scans
  robot.drive({{drive.back().time_s + kStepS, {1.8, 2.0, std::numbers::pi}}});
  (void)robot.wait_for(1);
  ASSERT_TRUE(robot.says("visits of landmarks", "3"));
  const topology::TopologySummary likeliest =
      convert::from_message(robot.seen_by_a_late_joiner().back()).front();
  EXPECT_EQ(likeliest.labels, (topology::Labels{0, 1, 1}));
  EXPECT_LT((likeliest.landmarks[1].mean.translation() - Eigen::Vector2d(9.0, 2.0)).norm(), 0.15);
}

TEST(TopologyMapper, IsDeactivatedOnAFullDiskAndKeepsWhatItHeardWhenThereIsRoom) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path store = folder.path() / "way.db";
  Robot robot("store: {file: '" + store.string() + "', save_period_s: 60}, save: '" +
              (folder.path() / "saved").string() + "'");
  ASSERT_TRUE(robot.says("visits of landmarks", "0"));  // its period of saving has begun
  const std::vector<Moment> drive = there_and_back();
  robot.drive({drive.begin(), drive.begin() + 10});
  ASSERT_TRUE(robot.says("received /scan", "10"));
  EXPECT_TRUE(memory::Store(store, {.read_only = true}).runs_with_scans().empty());
  EXPECT_THAT(test::deactivate_on_a_full_disk(robot.host()),
              ElementsAre(HasSubstr("way.db"), HasSubstr("saved")));
  EXPECT_THAT(memory::Store(store, {.read_only = true}).runs_with_scans(), ElementsAre(0));
}

TEST(TopologyMapper, KeepsNothingWhileItStandsAndKnowsAfterARestartThatItStoodThereTillNow) {
  const test::TemporaryDirectory folder;
  const std::string parameters =
      "store: {file: '" + (folder.path() / "way.db").string() + "', dead_reckoning_s: 1.0}";
  std::vector<Moment> drive = there_and_back();
  drive.resize(10);
  for (int i = 0; i < 30; ++i) {  // longer than dead_reckoning_s
    drive.push_back({drive.back().time_s + kStepS, drive.back().pose});
  }
  {
    Robot robot(parameters);
    robot.drive(drive);
    ASSERT_TRUE(robot.says("scans tracked", "40"));
    EXPECT_TRUE(robot.says("scans kept", "10"));
    EXPECT_TRUE(robot.says("scans left out", "0"));
    robot.end();
  }
  Robot robot(parameters);
  const Pose2 further = drive.back().pose * Pose2{1.0, 0.0, 0.0};
  for (int i = 1; i <= 3; ++i) robot.drive({{drive.back().time_s + kStepS * i, further}});
  ASSERT_TRUE(robot.says("scans tracked", "13"));
  EXPECT_TRUE(robot.says("scans kept", "11"));
  robot.end();
  const auto scans = memory::Store(folder.path() / "way.db", {.read_only = true}).load_scans(0);
  ASSERT_EQ(scans.size(), 11U);
  EXPECT_NEAR(translation_distance(scans[9].map_from_robot, scans[10].map_from_robot), 1.0, 0.05)
      << "its odometry has gone on";
}

// The driver is often started again together with the mapper.
TEST(TopologyMapper, FindsOutThatOdometryBeganAnewAMomentAgo) {
  const test::TemporaryDirectory folder;
  const std::string parameters = "store: {file: '" + (folder.path() / "way.db").string() + "'}";
  std::vector<Moment> drive = there_and_back();
  drive.resize(20);
  {
    Robot robot(parameters);
    robot.drive(drive);
    ASSERT_TRUE(robot.says("scans tracked", "20"));
    robot.end();
  }
  const Moment stood = drive.back();
  Robot robot(parameters);
  robot.drive({{stood.time_s + kStepS, stood.pose},
               {stood.time_s + 2 * kStepS, stood.pose * Pose2{kStepM, 0.0, 0.0}}},
              stood.pose);
  ASSERT_TRUE(robot.says("scans tracked", "22"));
  robot.end();
  const auto scans = memory::Store(folder.path() / "way.db", {.read_only = true}).load_scans(0);
  const Pose2 truth = between(drive.front().pose, stood.pose * Pose2{kStepM, 0.0, 0.0});
  EXPECT_LT(translation_distance(between(scans.front().map_from_robot, scans.back().map_from_robot),
                                 truth),
            0.1);
}

TEST(TopologyMapper, WarnsThatItsMapIsCompleteWhenItsMemoryIsUsedUp) {
  Robot robot("keep: {memory_mb: 0.01}");
  robot.drive(there_and_back());
  ASSERT_TRUE(robot.says("received /scan", "109"));
  EXPECT_THAT(robot.warning(), HasSubstr("keep.memory_mb"));
}

// As NTP sets it when it comes late: the robot drives on.
TEST(TopologyMapper, GoesOnWithItsWayWhenTheClockIsSetBack) {
  constexpr double kBack_s = 20.0;
  Robot robot("mapping: {landmarks: {source: given}}, published_topologies: 50");
  for (const double time_s : {kThere3, kThere9}) robot.mark(time_s);
  ASSERT_TRUE(robot.says("received /landmark", "2"));
  std::vector<Moment> drive = there_and_back();
  const auto turn = drive.begin() + 55;
  robot.drive({drive.begin(), turn});
  ASSERT_EQ(robot.wait_for(2).size(), 2U);
  ASSERT_TRUE(robot.says("scans tracked", "55"));
  for (auto later = turn; later != drive.end(); ++later) later->time_s -= kBack_s;
  robot.drive({turn, turn + 3});
  ASSERT_TRUE(robot.says("scans tracked", "58"));
  EXPECT_THAT(robot.host().take_errors(), testing::Contains(HasSubstr("the way is gone on with")));
  robot.mark(kBack9 - kBack_s);  // by the clock as it is now
  ASSERT_TRUE(robot.says("received /landmark", "3"));
  robot.drive({turn + 3, drive.end()});
  ASSERT_TRUE(robot.says("scans tracked", std::to_string(drive.size())));
  EXPECT_TRUE(robot.says("scans left out", "0"));
  const auto told = robot.wait_for(3);
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(convert::from_message(told.back()).front().labels, (topology::Labels{0, 1, 1}));
}

TEST(TopologyMapper, GoesOnFromAStoreThatIsAheadOfTheClock) {
  const test::TemporaryDirectory folder;
  const std::string parameters = "store: {file: '" + (folder.path() / "way.db").string() + "'}";
  std::vector<Moment> drive = there_and_back();
  {
    Robot robot(parameters);
    robot.drive({drive.begin() + 20, drive.begin() + 40});
    ASSERT_TRUE(robot.says("scans tracked", "20"));
    robot.end();
  }
  for (Moment& moment : drive) moment.time_s -= 20 * kStepS;
  Robot robot(parameters);
  robot.drive({drive.begin() + 40, drive.begin() + 50});
  ASSERT_TRUE(robot.says("scans tracked", "30"));
  EXPECT_TRUE(robot.says("scans left out", "0"));
  EXPECT_THAT(robot.host().take_errors(), testing::Contains(HasSubstr("ahead of the clock")));
}

TEST(TopologyMapper, NamesWhatItLeftOutOnDiagnostics) {
  Robot robot("mapping: {landmarks: {source: given}}");
  robot.mark(kThere9);
  ASSERT_TRUE(robot.says("received /landmark", "1"));
  std::vector<Moment> moments = there_and_back();
  robot.drive(moments);
  ASSERT_EQ(robot.wait_for(1).size(), 1U);
  robot.mark(kThere3);  // too late
  ASSERT_TRUE(robot.says("received /landmark", "2"));
  Moment beyond = moments.back();
  beyond.time_s += kStepS;
  Moment nowhere = beyond;
  nowhere.pose.x = std::numeric_limits<double>::quiet_NaN();
  const Pose2 further = beyond.pose * Pose2{kStepM, 0.0, 0.0};
  robot.drive({nowhere, moments.front(), {beyond.time_s + kStepS, further}});
  EXPECT_TRUE(robot.says("landmarks out of order", "1"));
  EXPECT_TRUE(robot.says("landmarks with broken odometry", "0"));
  EXPECT_TRUE(robot.says("landmarks nearly at one place", "0"));
  EXPECT_TRUE(robot.says("visits of landmarks", "1"));
  EXPECT_TRUE(robot.says("probability of the likeliest", "1"));
}

TEST(TopologyMapper, NamesMatchesThatFailPatchesWithoutPointsAndLandmarksWithinAMetre) {
  Robot robot(
      "mapping: {landmarks: {source: given}, topology: {match: {min_overlap: 1.0}, "
      "location: {revisit_stddev_m: 0.1, max_penalty: 0.0}}}, published_topologies: 50");
  constexpr double kBeside = kThere3 + 4 * kStepS;  // 0.8 m on
  std::vector<Moment> moments = there_and_back();
  // Then where nothing reflects.
  const double end_s = moments.back().time_s;
  for (int i = 1; i <= 60; ++i) {
    moments.push_back({end_s + kStepS * i, {2.0 - kStepM * i, -10.0, std::numbers::pi}});
  }
  const std::vector<double> marks{kThere3, kBeside, kBack9, end_s + 30 * kStepS};
  for (const double time_s : marks) robot.mark(time_s);
  ASSERT_TRUE(robot.says("received /landmark", "4"));
  robot.drive(moments);
  for (const Topologies& message : robot.wait_for(4)) expect_sound(message);
  EXPECT_TRUE(robot.says("visits of landmarks", "4"));
  EXPECT_TRUE(robot.says("landmarks without points around", "1"));
  EXPECT_TRUE(robot.says("landmarks nearly at one place", "1"));
  EXPECT_TRUE(robot.counts("local clouds that did not fit"));
  EXPECT_TRUE(robot.counts("topologies tried"));
}

}  // namespace
}  // namespace strata::topology_mapper
