// SPDX-License-Identifier: Apache-2.0
/// A localizer beside a robot: its services, and what it keeps for the next start.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/convert/map_messages.hpp"
#include "components/maps/maps_folder.hpp"
#include "tests/components/localizer/live_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::localizer {
namespace {

constexpr Duration kTolerance{1'000'000'000};  // AMCL's

TEST_F(LiveLocalizer, StartsAgainWhereAServiceSaysOrAnywhere) {
  const double settled_m2 = next_pose().pose().covariance()[0];
  nav2_msgs::srv::SetInitialPose_Request request;
  request.pose().header().frame_id("map");
  request.pose().pose(convert::to_pose_with_covariance(
      {Pose2{5.5, 3.5, 2.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
  const auto answer = bus::call_service<bus::srv::SetInitialPose>(
      robot_, "/set_initial_pose", request, std::chrono::seconds(20));
  ASSERT_TRUE(answer.has_value());
  const Pose2 there = planar(convert::from_message(next_pose().pose().pose()));
  EXPECT_LT(translation_distance(there, Pose2{5.5, 3.5, 2.0}), 0.5);
  ASSERT_TRUE(bus::call_service<bus::srv::Empty>(robot_, "/reinitialize_global_localization", {},
                                                 std::chrono::seconds(20))
                  .has_value());
  const auto anywhere = next_pose();
  EXPECT_GT(anywhere.pose().covariance()[0], 10.0 * settled_m2);
  EXPECT_GT(anywhere.pose().covariance()[0], 0.25);
  EXPECT_TRUE(host_->take_errors().empty());
}

// As a start script tells it, once, before a lifecycle manager has brought everything up.
TEST_F(LiveLocalizer, BeginsAtAPoseThatWasToldBeforeItWasActive) {
  (void)next_pose();
  runtime::Component& localizer = *host_->components().front();
  localizer.deactivate();
  bus::Writer<geometry_msgs::msg::PoseWithCovarianceStamped> start(robot_, "/initialpose",
                                                                   bus::qos_profile("default"));
  ASSERT_TRUE(start.raw().wait_for_readers(1, std::chrono::seconds(20)));
  geometry_msgs::msg::PoseWithCovarianceStamped told;
  told.header().frame_id("map");
  told.pose(convert::to_pose_with_covariance(
      {Pose2{5.5, 3.5, 2.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
  // The writer may know the reader before the reader knows it.
  const std::uint64_t before = localizer.counts().received;
  ASSERT_TRUE(test::comes_true([&] {
    start.publish(told);
    return localizer.counts().received > before;
  }));
  localizer.activate();
  const Pose2 there = planar(convert::from_message(next_pose().pose().pose()));
  EXPECT_LT(translation_distance(there, Pose2{5.5, 3.5, 2.0}), 0.5);
  EXPECT_TRUE(host_->take_errors().empty());
}

// As a node tells it that has seen a marker, and has worked on its picture for a while.
TEST_F(LiveLocalizer, TakesAPoseOfAMomentAgoOnByOdometry) {
  constexpr std::size_t kThen = 20;
  while (next_scan_ < kThen + 15) (void)next_pose();
  const Pose2 then = room().truth[kThen];
  ASSERT_GT(translation_distance(then, room().truth[next_scan_]), 0.4);
  nav2_msgs::srv::SetInitialPose_Request request;
  request.pose().header(convert::make_header(room().observations[kThen].scan.stamp, "map"));
  request.pose().pose(
      convert::to_pose_with_covariance({then, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
  ASSERT_TRUE(bus::call_service<bus::srv::SetInitialPose>(robot_, "/set_initial_pose", request,
                                                          std::chrono::seconds(20))
                  .has_value());
  const Pose2 there = planar(convert::from_message(next_pose().pose().pose()));
  EXPECT_LT(translation_distance(there, room().truth[next_scan_ - 1]), 0.15);
}

TEST_F(LiveLocalizer, TakesAPoseThatComesBeforeTheMapOnByOdometry) {
  start("{model: filtered}");
  nav2_msgs::srv::SetInitialPose_Request request;
  request.pose().header().frame_id("map");
  request.pose().pose(convert::to_pose_with_covariance(
      {room().truth[0], Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
  ASSERT_TRUE(bus::call_service<bus::srv::SetInitialPose>(robot_, "/set_initial_pose", request,
                                                          std::chrono::seconds(20))
                  .has_value());
  runtime::Component& localizer = *host_->components().front();
  while (translation_distance(room().truth[next_scan_], room().truth[0]) < 2.0) {
    ASSERT_LT(next_scan_, scan_count_ / 2);
    const std::uint64_t before = localizer.counts().processed;
    player_->publish(next_scan_++);
    // Odometry, its transform and the scan: who sends faster than they are worked on, loses some.
    ASSERT_TRUE(test::comes_true([&] { return localizer.counts().processed >= before + 3; }));
  }
  bus::Writer<strata_msgs::msg::ReflectionGrid> map(robot_, "/reflection_filtered",
                                                    bus::qos_profile("latched"));
  map.publish(convert::to_message(maps::read_maps(room().folder.path()).filtered));
  const Pose2 there = planar(convert::from_message(next_pose().pose().pose()));
  EXPECT_LT(translation_distance(there, room().truth[next_scan_ - 1]), 0.3);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveLocalizer, TellsWhereElseItMayBeWhenSomebodySaidAWrongPlace) {
  test::Collector<nav2_msgs::msg::ParticleCloud> candidates(robot_, "/place_candidates", "default");
  (void)next_pose();
  nav2_msgs::srv::SetInitialPose_Request request;
  request.pose().header().frame_id("map");
  request.pose().pose(convert::to_pose_with_covariance(
      {Pose2{5.5, 3.5, 2.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
  ASSERT_TRUE(bus::call_service<bus::srv::SetInitialPose>(robot_, "/set_initial_pose", request,
                                                          std::chrono::seconds(20))
                  .has_value());
  // The room looks the same from its other end, so it cannot know; but it says so.
  double nearest_m = 100.0;
  for (int i = 0; i < 40 && nearest_m > 0.3; ++i) {
    (void)next_pose();
    const auto clouds = candidates.wait_for(0);
    if (clouds.empty()) continue;
    for (const auto& place : clouds.back().particles()) {
      const Pose2 pose = planar(convert::from_message(place.pose()));
      nearest_m = std::min(nearest_m, translation_distance(pose, room().truth[next_scan_ - 1]));
    }
  }
  EXPECT_LT(nearest_m, 0.3);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveLocalizer, LocalizesFromTfAlone) {
  has_odometry_topic_ = false;
  test::Collector<tf2_msgs::msg::TFMessage> transforms(robot_, "/tf", "tf");
  geometry_msgs::msg::PoseWithCovarianceStamped last;
  std::size_t poses = 0;
  for (; next_scan_ < room().observations.size(); ++poses) last = next_pose();
  EXPECT_GT(poses, 10U);
  const Pose2 pose = planar(convert::from_message(last.pose().pose()));
  const Stamp stamp = convert::from_message(last.header().stamp());
  std::size_t scan = 0;
  while (room().observations[scan].scan.stamp != stamp) ASSERT_LT(++scan, room().truth.size());
  EXPECT_LT(translation_distance(pose, room().truth[scan]), 0.1);
  // It knows the odometry of that very scan: what it says of map and odom leads to the pose.
  std::optional<Pose2> map_from_odom;
  for (std::size_t seen = 0; !map_from_odom;) {
    const auto messages = transforms.wait_for(seen + 1);
    ASSERT_GT(messages.size(), seen) << "nothing more comes on /tf";
    for (; seen < messages.size(); ++seen) {
      const auto& transform = messages[seen].transforms()[0];
      if (transform.child_frame_id() != "odom" ||
          convert::from_message(transform.header().stamp()) != stamp + kTolerance) {
        continue;
      }
      map_from_odom = planar(convert::from_message(transform.transform()));
    }
  }
  EXPECT_LT(translation_distance(*map_from_odom * room().observations[scan].odom_from_robot, pose),
            1e-6);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveLocalizer, ShowsLateJoinersTheMapThatItBelievesInAndSendsItOnlyWhenThatChanges) {
  test::Collector<nav_msgs::msg::OccupancyGrid> early(robot_, "/map_current", "latched");
  (void)next_pose();
  ASSERT_EQ(early.wait_for(1).size(), 1U);
  (void)next_pose();
  (void)next_pose();
  test::Collector<nav_msgs::msg::OccupancyGrid> late(robot_, "/map_current", "latched");
  const auto maps = late.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  // What stops a beam in the map is a wall, whatever part of all beams it stops.
  ReflectionGrid walls = maps::read_maps(room().folder.path()).filtered;
  for (float& value : walls.values()) {
    if (is_known(value)) value = is_occupied(value) ? 1.0F : 0.0F;
  }
  const nav_msgs::msg::OccupancyGrid expected =
      convert::to_occupancy(walls, Stamp::from_seconds(0.0), "map");
  EXPECT_EQ(maps[0].data(), expected.data());
  EXPECT_EQ(maps[0].info().width(), expected.info().width());
  EXPECT_EQ(maps[0].header().frame_id(), "map");
  EXPECT_EQ(early.wait_for(1).size(), 1U);
}

TEST_F(LiveLocalizer, BeginsAtItsStartWhenItIsConfiguredAgain) {
  // Its map comes by topic, and again when it is configured again.
  const std::string parameters = parameters_of("filtered", false);
  start("{" + parameters.substr(parameters.find("model:")));
  bus::Writer<strata_msgs::msg::ReflectionGrid> map(robot_, "/reflection_filtered",
                                                    bus::qos_profile("latched"));
  map.publish(convert::to_message(maps::read_maps(room().folder.path()).filtered));
  const auto next_place = [&] { return planar(convert::from_message(next_pose().pose().pose())); };
  Pose2 place = next_place();
  while (translation_distance(place, room().start) < 1.5) place = next_place();
  runtime::Component& localizer = *host_->components().front();
  localizer.deactivate();
  localizer.cleanup();
  localizer.configure();
  localizer.activate();
  EXPECT_LT(translation_distance(next_place(), room().start), 0.7);
  EXPECT_TRUE(host_->take_errors().empty());
}

// As a SLAM publishes it that has seen nothing yet.
TEST_F(LiveLocalizer, BeginsInTheNextMapWhereTheFirstOneHasNoFreeCell) {
  start("{model: occupancy, localizer: {global_start: {max_particles: 3000}}}");
  bus::Writer<nav_msgs::msg::OccupancyGrid> map(robot_, "/map", bus::qos_profile("latched"));
  map.publish(
      convert::to_occupancy(make_reflection_grid(0.05, {{0, 0}, {40, 40}}), Stamp(), "map"));
  std::vector<std::string> errors;
  while (errors.empty() && next_scan_ < scan_count_ / 2) {
    player_->publish(next_scan_++);
    (void)poses_.wait_for(1, std::chrono::milliseconds(100));
    errors = host_->take_errors();
  }
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], ::testing::HasSubstr("no free cell"));
  map.publish(
      convert::to_occupancy(maps::read_maps(room().folder.path()).occupancy, Stamp(), "map"));
  (void)next_pose();
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveLocalizer, GoesOnWhereItWasWhenItsProcessEnds) {
  const test::TemporaryDirectory folder;
  const auto with_store = [&](bool knows_start) {
    const fs::path file = folder.path() / "place.yaml";
    std::string text = parameters_of("filtered", !knows_start);
    const std::string group = "start: {";
    const std::string store = "store: {file: '" + file.string() + "', period_s: 0}";
    if (knows_start) return text.replace(text.find(group), group.size(), group + store + ", ");
    text.pop_back();
    return text + ", start: {" + store + "}}";
  };
  start(with_store(true));
  Pose2 before;
  for (int i = 0; i < 5; ++i) before = planar(convert::from_message(next_pose().pose().pose()));
  start(with_store(false));  // knows no start but that of the store
  const auto after = next_pose();
  EXPECT_LT(translation_distance(planar(convert::from_message(after.pose().pose())), before), 0.5);
  EXPECT_LT(after.pose().covariance()[0], 0.1);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveLocalizer, StartsWithoutAStoreThatIsDamagedAndSaysSo) {
  const test::TemporaryDirectory folder;
  const fs::path file = folder.path() / "place.yaml";
  std::ofstream(file) << "version: 1\nmap_from_robot: [1, 2]\n";
  std::string text = parameters_of("filtered", true);
  text.pop_back();
  start(text + ", start: {store: {file: '" + file.string() + "'}}}");
  const auto errors = host_->take_errors();
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], ::testing::HasSubstr("place.yaml"));
  EXPECT_THAT(errors[0], ::testing::HasSubstr("map_from_robot"));
  EXPECT_GT(next_pose().pose().covariance()[0], 0.1) << "anywhere";
}

TEST_F(LiveLocalizer, TellsWhyAPoseInAnotherFrameIsRefused) {
  nav2_msgs::srv::SetInitialPose_Request request;
  request.pose().header().frame_id("kitchen");
  ASSERT_TRUE(bus::call_service<bus::srv::SetInitialPose>(robot_, "/set_initial_pose", request,
                                                          std::chrono::seconds(20))
                  .has_value());
  const auto errors = host_->take_errors();
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0], ::testing::HasSubstr("set_initial_pose"));
  EXPECT_THAT(errors[0], ::testing::HasSubstr("kitchen"));
}

}  // namespace
}  // namespace strata::localizer
