// SPDX-License-Identifier: Apache-2.0
/// What a live localizer keeps of its run, and what comes out when that is gone through again.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/localizer/journal_replay.hpp"
#include "tests/components/localizer/journal_fixture.hpp"

namespace strata::localizer {
namespace {

using rcl_interfaces::msg::ParameterEvent;
using strata_msgs::msg::LabeledScan;
using ::testing::HasSubstr;

TEST_F(LocalizerJournal, GivesThePosesThatTheRobotPublishedToTheBit) {
  for (const std::string model : {"patch", "filtered"}) {
    SCOPED_TRACE(model);
    begin(model);
    const auto poses = drive(25);
    const JournalReplay::Outcome outcome = run(journal(poses.size()));
    EXPECT_TRUE(outcome.is_same());
    EXPECT_EQ(outcome.restored, 1U);
    EXPECT_GT(outcome.compared, 1U);
    EXPECT_EQ(outcome.same_states, outcome.compared);
    EXPECT_EQ(replayed_, poses);
  }
}

TEST_F(LocalizerJournal, GivesThePosesOfARobotThatLocalMapsLeadBeyondItsMap) {
  // Any scan counts as beyond it.
  begin("filtered", ", localizer: {beyond_map: {is_used: true, begin_share: 0.0}}");
  const auto poses = drive(25);
  const JournalReplay::Outcome outcome = run(journal(poses.size()));
  EXPECT_TRUE(outcome.is_same());
  EXPECT_GT(outcome.compared, 1U);
  EXPECT_EQ(replayed_, poses);
}

TEST_F(LocalizerJournal, GoesThroughWhatOthersAskOfTheFilter) {
  begin("patch", ", localizer: {global_start: {max_particles: 2000}}");
  auto poses = drive(8);
  ASSERT_TRUE(bus::call_service<bus::srv::Empty>(robot_, "/reinitialize_global_localization", {},
                                                 std::chrono::seconds(20)));
  const auto anywhere = drive(8);
  ASSERT_TRUE(bus::call_service<bus::srv::Empty>(robot_, "/request_nomotion_update", {},
                                                 std::chrono::seconds(20)));
  const auto weighed = drive(4);
  nav2_msgs::srv::SetInitialPose_Request request;
  request.pose().header().frame_id("map");
  request.pose().pose(convert::to_pose_with_covariance(
      {Pose2{5.5, 3.5, 2.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
  ASSERT_TRUE(bus::call_service<bus::srv::SetInitialPose>(robot_, "/set_initial_pose", request,
                                                          std::chrono::seconds(20)));
  const auto there = drive(6);
  for (const auto* more : {&anywhere, &weighed, &there}) {
    poses.insert(poses.end(), more->begin(), more->end());
  }
  const JournalReplay::Outcome outcome = run(journal(poses.size()));
  EXPECT_TRUE(outcome.is_same());
  EXPECT_EQ(outcome.restored, 4U) << "the start, and three times that somebody asked";
  EXPECT_EQ(replayed_, poses);
}

TEST_F(LocalizerJournal, IsNotTheSameWhenABeamIsAnotherOne) {
  begin("filtered");
  (void)drive(25);
  auto scans = scans_->wait_for(25);
  const std::size_t beam = scans[5].scan().ranges().size() / 2;
  for (std::size_t n = 5; n < 12; ++n) scans[n].scan().ranges()[beam] *= 0.5F;
  JournalReplay journal;
  for (const LabeledScan& scan : scans) journal.add(scan);
  for (const ParameterEvent& point : points_->wait_for(1)) journal.add(restore_point(point));
  const JournalReplay::Outcome outcome = run(journal);
  EXPECT_FALSE(outcome.is_same());
  EXPECT_LT(outcome.same, outcome.replayed);
  EXPECT_LT(outcome.same_states, outcome.compared);
  ASSERT_TRUE(outcome.first_difference);
  EXPECT_GE(*outcome.first_difference, convert::from_message(scans[5].scan().header().stamp()));
}

TEST_F(LocalizerJournal, LeavesOutWhatComesBehindAGapUntilTheNextRestorePoint) {
  begin("filtered");
  (void)drive(25);
  JournalReplay journal;
  auto points = points_->wait_for(2);
  const RestorePoint first = restore_point(points.front());
  const auto scans = scans_->wait_for(25);
  for (const LabeledScan& scan : scans) {
    if (scan.pose().index() != first.next_scan + 2) journal.add(scan);
  }
  for (const ParameterEvent& point : points) journal.add(restore_point(point));
  const JournalReplay::Outcome outcome = run(journal);
  EXPECT_TRUE(outcome.is_same());
  EXPECT_EQ(outcome.scans, 24U);
  EXPECT_LT(outcome.replayed, 24U);
  EXPECT_EQ(outcome.restored, 2U);
}

TEST_F(LocalizerJournal, OfMapsThatCameOverTopicsIsRefused) {
  begin("filtered");
  (void)drive(5);
  JournalReplay journal;
  for (const LabeledScan& scan : scans_->wait_for(5)) journal.add(scan);
  RestorePoint point = restore_point(points_->wait_for(1).front());
  point.maps_sha256.clear();
  journal.add(point);
  EXPECT_THAT([&] { (void)run(journal); },
              testing::ThrowsMessage<InputError>(HasSubstr("came over topics")));
}

TEST_F(LocalizerJournal, IsKeptOnlyWhileSomebodyReadsIt) {
  begin("filtered", "");
  (void)drive(3);
  EXPECT_EQ(scans_->wait_for(3).size(), 3U);
  points_.reset();
  scans_.reset();
  (void)drive(3);
  points_.emplace(robot_, "/localizer/_restore_point", "default");
  scans_.emplace(robot_, "/localizer/_journal", "tf");
  ASSERT_TRUE(points_->wait_for_writer());
  ASSERT_TRUE(scans_->wait_for_writer());
  (void)drive(3);
  const auto scans = scans_->wait_for(1);
  ASSERT_FALSE(scans.empty());
  const RestorePoint point = restore_point(points_->wait_for(1).front());
  EXPECT_FALSE(point.goes_on) << "who reads from here on cannot know what was before";
  EXPECT_GE(point.next_scan, scans.front().pose().index());
}

TEST(RestorePoint, KeepsItsValuesAndRefusesMessagesThatLackOne) {
  RestorePoint point;
  point.localizer = "/robot1/localizer";
  point.stamp = Stamp{1'700'000'000'123'456'789};
  point.next_scan = 0xFEDCBA9876543210U;
  point.goes_on = true;
  point.seed = 0xFFFFFFFFFFFFFFFFU;
  point.settings = "model: patch\n";
  point.maps = "maps";
  point.maps_sha256 = "0123";
  point.map_messages = {{"/map", "nav_msgs/msg/OccupancyGrid", "4567"},
                        {"/node_map", "strata_msgs/msg/NodeMap", ""}};
  point.state = {0, 255, 7};
  const ParameterEvent message = to_message(point);
  const RestorePoint back = restore_point(message);
  EXPECT_EQ(back.localizer, point.localizer);
  EXPECT_EQ(back.stamp, point.stamp);
  EXPECT_EQ(back.next_scan, point.next_scan);
  EXPECT_EQ(back.goes_on, point.goes_on);
  EXPECT_EQ(back.seed, point.seed);
  EXPECT_EQ(back.settings, point.settings);
  EXPECT_EQ(back.maps, point.maps);
  EXPECT_EQ(back.maps_sha256, point.maps_sha256);
  EXPECT_EQ(back.map_messages, point.map_messages);
  EXPECT_EQ(back.state, point.state);
  for (std::size_t n = 0; n < message.new_parameters().size(); ++n) {
    ParameterEvent less = message;
    less.new_parameters().erase(less.new_parameters().begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_THROW((void)restore_point(less), InputError) << n;
    ParameterEvent other = message;
    other.new_parameters()[n].value().type(9);
    EXPECT_THROW((void)restore_point(other), InputError) << n;
  }
}

}  // namespace
}  // namespace strata::localizer
