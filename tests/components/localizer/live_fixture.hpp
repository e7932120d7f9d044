// SPDX-License-Identifier: Apache-2.0
/// A localizer as it runs beside a robot, and the robot.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/localizer/register.hpp"
#include "components/player/log_player.hpp"
#include "components/runtime/host.hpp"
#include "tests/components/localizer/room_fixture.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::localizer {

class LiveLocalizer : public ::testing::Test {
 protected:
  /// In the room, where one runs already.
  LiveLocalizer() : LiveLocalizer(room().observations) { start(parameters_of("filtered", false)); }
  /// Where the robot sees this; nobody localizes it yet.
  explicit LiveLocalizer(std::vector<Observation> observations) : scan_count_(observations.size()) {
    player::Outputs outputs;
    outputs.clock = [](const auto&) {};
    outputs.tf_static = [this](const auto& message) { tf_static_.publish(message); };
    outputs.tf = [this](const auto& message) { tf_.publish(message); };
    outputs.odometry = [this](const auto& message) {
      if (has_odometry_topic_) odometry_.publish(message);
    };
    outputs.scan = [this](const auto& message) { scan_.publish(message); };
    player_.emplace(std::move(observations), outputs);
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
    // What the robot drives before it is heard would be missing from its odometry.
    for (bus::RawWriter* writer : {&tf_static_.raw(), &tf_.raw(), &odometry_.raw(), &scan_.raw()}) {
      EXPECT_TRUE(writer->wait_for_readers(1, std::chrono::seconds(20))) << writer->topic();
    }
  }

  /// Plays on until a pose comes; scans without odometry beside them give none.
  [[nodiscard]] geometry_msgs::msg::PoseWithCovarianceStamped next_pose() {
    const std::size_t before = poses_.wait_for(0).size();
    while (next_scan_ < scan_count_) {
      player_->publish(next_scan_++);
      const auto poses = poses_.wait_for(before + 1, std::chrono::milliseconds(500));
      if (poses.size() > before) return poses.back();
    }
    ADD_FAILURE() << "no pose came";
    return {};
  }

  /// What the localizer's status says under that key, as soon as it says `wanted`, else at last.
  [[nodiscard]] std::string status(const std::string& key, const std::string& wanted) {
    std::string said;
    (void)test::comes_true([&] {
      host_->tick();
      const auto all = diagnostics_.wait_for(0);
      if (all.empty()) return false;
      for (const auto& one : all.back().status()) said = runtime::value_of(one, key);
      return said == wanted;
    });
    return said;
  }

  std::shared_ptr<bus::Participant> robot_ = test::make_participant();
  bus::Writer<tf2_msgs::msg::TFMessage> tf_static_{robot_, "/tf_static",
                                                   bus::qos_profile("latched")};
  bus::Writer<tf2_msgs::msg::TFMessage> tf_{robot_, "/tf", bus::qos_profile("tf")};
  bus::Writer<nav_msgs::msg::Odometry> odometry_{robot_, "/odom", bus::qos_profile("default")};
  bus::Writer<sensor_msgs::msg::LaserScan> scan_{robot_, "/scan", bus::qos_profile("default")};
  test::Collector<geometry_msgs::msg::PoseWithCovarianceStamped> poses_{robot_, "/amcl_pose",
                                                                        "default"};
  test::Collector<diagnostic_msgs::msg::DiagnosticArray> diagnostics_{robot_, "/diagnostics",
                                                                      "default"};
  std::optional<player::LogPlayer> player_;
  std::size_t scan_count_;
  std::size_t next_scan_ = 0;
  bool has_odometry_topic_ = true;  ///< else the robot tells its odometry by /tf alone
  std::unique_ptr<runtime::Host> host_;
};

}  // namespace strata::localizer
