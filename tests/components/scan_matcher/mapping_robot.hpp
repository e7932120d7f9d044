// SPDX-License-Identifier: Apache-2.0
/// A robot's sensors, and a mapping process that can be ended and begun again.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/state_store.hpp"
#include "components/scan_matcher/register.hpp"
#include "core/slam/slam.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/laser_mounting.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/core/slam/ring_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::scan_matcher {

using strata_msgs::msg::ScanPose;

class MappingRobot : public ::testing::Test {
 protected:
  MappingRobot()
      : participant_(test::make_participant()),
        scans_(participant_, "/scan", bus::qos_profile("lossless")),
        odometry_(participant_, "/odom", bus::qos_profile("lossless")),
        tf_static_(participant_, "/tf_static", bus::qos_profile("tf_static")) {
    tf_static_.publish(test::laser_mounting());
    register_component(registry_);
  }
  /// parameters: further ones, YAML.
  void begin(const std::string& parameters) {
    poses_ = std::make_unique<test::Collector<ScanPose>>(participant_, "/scan_pose", "lossless");
    host_ = test::make_host(
        "{type: strata::ScanMatcher, name: slam, parameters: {sensor_qos: lossless, " + parameters +
            "}}",
        registry_, test::make_participant());
    host_->activate();
    EXPECT_TRUE(scans_.raw().wait_for_readers(1, std::chrono::seconds(20)));
    hear_odometry();
  }
  /// A replay is short, and what is published before the reader knows its writer is lost.
  void hear_odometry() {
    test::StatusWatch watch(participant_);
    const auto status = watch.wait_for(*host_, [&](const auto& now) {
      odometry_.publish(convert::to_odometry(Stamp{1}, Pose2{}, "odom", "base_link"));
      const std::string received = test::value_of(now, "received /odom");
      return !received.empty() && received != "0";
    });
    EXPECT_NE(test::value_of(status, "received /odom"), "");
  }
  /// The poses that were told of the scans, when the last one's has come.
  std::vector<ScanPose> drive(const std::vector<Observation>& log) {
    for (const Observation& observation : log) {
      odometry_.publish(convert::to_odometry(observation.scan.stamp, observation.odom_from_robot,
                                             "odom", "base_link"));
      scans_.publish(convert::to_message(observation.scan, "laser"));
    }
    std::vector<ScanPose> told = poses_->wait_for(1);
    const auto is_last = [&](const ScanPose& pose) {
      return convert::from_message(pose.header().stamp()) == log.back().scan.stamp;
    };
    while (!told.empty() && !is_last(told.back())) {
      std::vector<ScanPose> more = poses_->wait_for(told.size() + 1);
      if (more.size() == told.size()) break;
      told = std::move(more);
    }
    return told;
  }
  void end() { host_.reset(); }

  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_;
  std::unique_ptr<test::Collector<ScanPose>> poses_;
  bus::Writer<sensor_msgs::msg::LaserScan> scans_;
  bus::Writer<nav_msgs::msg::Odometry> odometry_;
  bus::Writer<tf2_msgs::msg::TFMessage> tf_static_;
  runtime::Registry registry_;
  std::unique_ptr<runtime::Host> host_;
};

inline Pose2 pose_of(const ScanPose& message) {
  return convert::from_message(message.map_from_robot().mean());
}

/// The same, by a clock that is so much ahead.
inline std::vector<Observation> by_clock(std::vector<Observation> log, double ahead_s) {
  for (Observation& observation : log) {
    observation.scan.stamp = observation.scan.stamp + Duration::from_seconds(ahead_s);
  }
  return log;
}

/// Most of the way round the block, and what was recorded.
struct Drive {
  std::vector<Pose2> path = test::drive_round(0.1, 30.0);
  std::vector<Observation> log = test::record(test::ring(), path, 0, 5);

  /// Where the robot was at that scan.
  [[nodiscard]] Pose2 truth(const ScanPose& message, double later_s = 0.0) const {
    const double since_s = convert::from_message(message.header().stamp()).seconds() - later_s;
    return path.at(static_cast<std::size_t>(since_s / 0.2 + 0.5));
  }
};

}  // namespace strata::scan_matcher
