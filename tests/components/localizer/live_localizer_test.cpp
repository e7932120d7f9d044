// SPDX-License-Identifier: Apache-2.0
/// A localizer beside a robot: its services, and what it keeps for the next start.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/localizer/register.hpp"
#include "components/player/log_player.hpp"
#include "components/runtime/host.hpp"
#include "tests/components/localizer/room_fixture.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::localizer {
namespace {

/// A localizer as it runs beside a robot, and the robot.
class LiveLocalizer : public ::testing::Test {
 protected:
  LiveLocalizer() {
    start(parameters_of("filtered", false));
    player::Outputs outputs;
    outputs.clock = [](const auto&) {};
    outputs.tf_static = [this](const auto& message) { tf_static_.publish(message); };
    outputs.tf = [this](const auto& message) { tf_.publish(message); };
    outputs.odometry = [this](const auto& message) { odometry_.publish(message); };
    outputs.scan = [this](const auto& message) { scan_.publish(message); };
    player_.emplace(room().observations, outputs);
  }

  /// In the place of the one that runs.
  void start(const std::string& parameters) {
    host_.reset();
    const runtime::Composition composition = composition_of(parameters);
    runtime::Registry registry;
    register_component(registry);
    host_ = std::make_unique<runtime::Host>(composition, composition.processes[0], registry,
                                            runtime::make_participant(composition),
                                            runtime::HostOptions{.seed = kSeed});
    host_->activate();
  }

  /// Plays on until a pose comes; scans without odometry beside them give none.
  [[nodiscard]] geometry_msgs::msg::PoseWithCovarianceStamped next_pose() {
    const std::size_t before = poses_.wait_for(0).size();
    while (next_scan_ < room().observations.size()) {
      player_->publish(next_scan_++);
      const auto poses = poses_.wait_for(before + 1, std::chrono::milliseconds(500));
      if (poses.size() > before) return poses.back();
    }
    ADD_FAILURE() << "no pose came";
    return {};
  }

  std::shared_ptr<bus::Participant> robot_ = test::make_participant();
  bus::Writer<tf2_msgs::msg::TFMessage> tf_static_{robot_, "/tf_static",
                                                   bus::qos_profile("latched")};
  bus::Writer<tf2_msgs::msg::TFMessage> tf_{robot_, "/tf", bus::qos_profile("tf")};
  bus::Writer<nav_msgs::msg::Odometry> odometry_{robot_, "/odom", bus::qos_profile("default")};
  bus::Writer<sensor_msgs::msg::LaserScan> scan_{robot_, "/scan", bus::qos_profile("default")};
  test::Collector<geometry_msgs::msg::PoseWithCovarianceStamped> poses_{robot_, "/amcl_pose",
                                                                        "default"};
  std::optional<player::LogPlayer> player_;
  std::size_t next_scan_ = 0;
  std::unique_ptr<runtime::Host> host_;
};

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
