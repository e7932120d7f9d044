// SPDX-License-Identifier: Apache-2.0
/// What nav2 and RViz expect of AMCL, and find in a localizer.
#include <chrono>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "tests/components/localizer/live_fixture.hpp"

namespace strata::localizer {
namespace {

using LikeAmcl = LiveLocalizer;

constexpr Duration kTolerance{1'000'000'000};  // AMCL's

/// What tf2's buffer finds at a stamp among the samples of one frame: nothing before the first and
/// after the last one, between two what lies between.
std::optional<Pose2> look_up(const std::map<Stamp, Pose2>& samples, Stamp stamp) {
  const auto after = samples.lower_bound(stamp);
  if (after == samples.end()) return std::nullopt;
  if (after->first == stamp) return after->second;
  if (after == samples.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double share = (stamp - before->first).seconds() / (after->first - before->first).seconds();
  const Pose2 step = between(before->second, after->second);
  return before->second * Pose2{share * step.x, share * step.y, share * step.theta};
}

/// map -> odom as a costmap's buffer has it.
std::map<Stamp, Pose2> corrections_in(const std::vector<tf2_msgs::msg::TFMessage>& messages) {
  std::map<Stamp, Pose2> samples;
  for (const auto& message : messages) {
    for (const auto& transform : message.transforms()) {
      if (transform.header().frame_id() != "map") continue;
      samples[convert::from_message(transform.header().stamp())] =
          planar(convert::from_message(transform.transform()));
    }
  }
  return samples;
}

TEST_F(LikeAmcl, TellsACostmapBetweenTwoScansWhereTheRobotIsNow) {
  test::Collector<tf2_msgs::msg::TFMessage> transforms(robot_, "/tf", "tf");
  ASSERT_TRUE(transforms.wait_for_writer());
  std::size_t poses = 0;
  Stamp last;
  while (next_scan_ < room().observations.size()) {
    last = convert::from_message(next_pose().header().stamp());
    ++poses;
  }
  // The transform goes out behind its pose; those of the fixture's own /tf come beside them.
  std::map<Stamp, Pose2> samples;
  for (std::size_t seen = 0; samples.empty() || samples.rbegin()->first < last + kTolerance;) {
    const auto messages = transforms.wait_for(seen + 1);
    ASSERT_GT(messages.size(), seen) << "nothing more comes on /tf";
    seen = messages.size();
    samples = corrections_in(messages);
  }
  EXPECT_EQ(samples.size(), poses);
  for (const double age_s : {0.0, 0.05, 0.5, 1.0}) {
    const auto now = last + Duration::from_seconds(age_s);
    const std::optional<Pose2> map_from_odom = look_up(samples, now);
    ASSERT_TRUE(map_from_odom) << age_s << " s after the last scan";
    std::size_t scan = room().observations.size();
    while (room().observations[--scan].scan.stamp != last) ASSERT_GT(scan, 0U);
    const Pose2 place = *map_from_odom * room().observations[scan].odom_from_robot;
    EXPECT_LT(translation_distance(place, room().truth[scan]), 0.15) << age_s;
  }
  EXPECT_FALSE(look_up(samples, last + Duration::from_seconds(1.001)))
      << "older than it may be used";
}

TEST_F(LikeAmcl, TellsNoTransformBeforeAFirstPlaceIsFound) {
  // More places fit than are kept: it waits for more scans.
  start("{maps: '" + room().folder.path().string() +
        "', model: filtered, localizer: {global_search: {patience: 6, search: {max_candidates: "
        "1}}}}");
  test::Collector<tf2_msgs::msg::TFMessage> transforms(robot_, "/tf", "tf");
  test::Collector<nav2_msgs::msg::ParticleCloud> candidates(robot_, "/place_candidates", "default");
  ASSERT_TRUE(transforms.wait_for_writer() && candidates.wait_for_writer());
  std::optional<Stamp> found;
  Stamp last;
  for (std::size_t empty = 0; !found && next_scan_ < scan_count_;) {
    last = convert::from_message(next_pose().header().stamp());
    for (const auto& cloud : candidates.wait_for(++empty)) {
      if (found || cloud.particles().empty()) continue;
      found = convert::from_message(cloud.header().stamp());
      EXPECT_GT(empty, 4U) << "nothing was waited for";
    }
  }
  ASSERT_TRUE(found);
  std::map<Stamp, Pose2> samples;
  for (std::size_t seen = 0; !samples.contains(last + kTolerance);) {
    const auto messages = transforms.wait_for(seen + 1);
    ASSERT_GT(messages.size(), seen) << "nothing more comes on /tf";
    seen = messages.size();
    samples = corrections_in(messages);
  }
  EXPECT_EQ(samples.begin()->first, *found + kTolerance);
}

TEST_F(LikeAmcl, DatesTheTransformAsItsParameterSays) {
  std::string text = parameters_of("filtered", false);
  text.pop_back();
  start(text + ", transform_tolerance: 0.25}");
  test::Collector<tf2_msgs::msg::TFMessage> transforms(robot_, "/tf", "tf");
  ASSERT_TRUE(transforms.wait_for_writer());
  const Stamp stamp = convert::from_message(next_pose().header().stamp());
  std::map<Stamp, Pose2> samples;
  for (std::size_t seen = 0; !samples.contains(stamp + Duration::from_seconds(0.25));) {
    const auto messages = transforms.wait_for(seen + 1);
    ASSERT_GT(messages.size(), seen) << "nothing more comes on /tf";
    seen = messages.size();
    samples = corrections_in(messages);
  }
}

TEST_F(LikeAmcl, TellsWhoComesLateTheLastPoseAndHearsWhoSetsOneVolatile) {
  const auto last = next_pose();
  test::Collector<geometry_msgs::msg::PoseWithCovarianceStamped> late(robot_, "/amcl_pose",
                                                                      "latched");
  const auto poses = late.wait_for(1);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0], last);
  // As RViz does: a reader that asked for transient local would refuse it.
  bus::Writer<geometry_msgs::msg::PoseWithCovarianceStamped> rviz(robot_, "/initialpose",
                                                                  bus::qos_profile("default"));
  ASSERT_TRUE(rviz.raw().wait_for_readers(1, std::chrono::seconds(20)));
  auto request = last;
  const Pose2 there{5.5, 3.5, 2.0};
  request.pose(
      convert::to_pose_with_covariance({there, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
  rviz.publish(request);
  Pose2 place = planar(convert::from_message(next_pose().pose().pose()));
  while (translation_distance(place, there) > 0.5 && next_scan_ < room().observations.size()) {
    place = planar(convert::from_message(next_pose().pose().pose()));
  }
  EXPECT_LT(translation_distance(place, there), 0.5);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LikeAmcl, UsesTheNextScanOfARobotThatStandsStillOnRequest) {
  std::string text = parameters_of("filtered", false);
  text.pop_back();
  start(text +
        ", sensor_qos: default, localizer: {gating: {translation_m: 1000, rotation_rad: "
        "1000, every_scans: 1000000}}}");
  test::Collector<nav2_msgs::msg::ParticleCloud> clouds(robot_, "/particle_cloud", "default");
  ASSERT_TRUE(clouds.wait_for_writer());
  std::size_t seen = 0;
  const auto next_weights = [&] {
    (void)next_pose();
    const auto all = clouds.wait_for(++seen);
    std::vector<double> weights;
    if (all.size() < seen) return weights;
    for (const auto& particle : all[seen - 1].particles()) weights.push_back(particle.weight());
    return weights;
  };
  const std::vector<double> first = next_weights();
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(next_weights(), first) << "gated: moved only";
  ASSERT_TRUE(bus::call_service<bus::srv::Empty>(robot_, "/request_nomotion_update", {},
                                                 std::chrono::seconds(20))
                  .has_value());
  EXPECT_NE(next_weights(), first);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LikeAmcl, RefusesParametersThatItCouldNotBeConfiguredWith) {
  (void)next_pose();
  rcl_interfaces::srv::SetParameters_Request request;
  const auto text = [](const std::string& value) { return runtime::parameter_value(value); };
  request.parameters({runtime::parameter("pose_qos", text("latchd")),
                      runtime::parameter("model", text("banana")),
                      runtime::parameter("maps", text("/no/such/folder")),
                      runtime::parameter("pose_topic", text("no topic")),
                      runtime::parameter("model", text("occupancy"))});
  const auto response = bus::call_service<bus::srv::SetParameters>(
      robot_, "/localizer/set_parameters", request, std::chrono::seconds(60));
  ASSERT_TRUE(response.has_value());
  ASSERT_EQ(response->results().size(), 5U);
  const char* const reasons[] = {"unknown profile 'latchd'", "banana", "/no/such/folder",
                                 "no topic"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(response->results()[i].successful()) << reasons[i];
    EXPECT_THAT(response->results()[i].reason(), ::testing::HasSubstr(reasons[i]));
  }
  EXPECT_TRUE(response->results()[4].successful()) << response->results()[4].reason();
  (void)next_pose();
  runtime::Component& localizer = *host_->components().front();
  localizer.deactivate();
  localizer.cleanup();
  localizer.configure();
  localizer.activate();
  (void)next_pose();
  EXPECT_TRUE(host_->take_errors().empty());
}

}  // namespace
}  // namespace strata::localizer
