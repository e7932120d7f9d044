// SPDX-License-Identifier: Apache-2.0
/// A robot, and the component that tells its places apart.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/topology_mapper/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/laser_mounting.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/components/topology_mapper/niche_room.hpp"

namespace strata::topology_mapper {

using geometry_msgs::msg::PointStamped;
using strata_msgs::msg::Topologies;

inline PointStamped landmark_at(double time_s) {
  PointStamped message;
  message.header(convert::make_header(Stamp::from_seconds(time_s), "base_link"));
  return message;
}

/// A robot that publishes, and what the component answers.
class Robot {
 public:
  explicit Robot(const std::string& parameters)
      : participant_(test::make_participant()),
        watch_(participant_),
        topologies_(participant_, "/topologies", "lossless"),
        scans_(participant_, "/scan", bus::qos_profile("lossless")),
        odometry_(participant_, "/odom", bus::qos_profile("lossless")),
        landmarks_(participant_, "/landmark", bus::qos_profile("default")),
        tf_static_(participant_, "/tf_static", bus::qos_profile("tf_static")) {
    tf_static_.publish(test::laser_mounting());
    register_component(registry_);
    host_ = test::make_host(
        "{type: strata::TopologyMapper, name: mapper, parameters: {sensor_qos: lossless, " +
            parameters + "}}",
        registry_, test::make_participant());
    host_->activate();
    const std::chrono::seconds patience(20);
    EXPECT_TRUE(scans_.raw().wait_for_readers(1, patience));
    EXPECT_TRUE(odometry_.raw().wait_for_readers(1, patience));
    EXPECT_TRUE(landmarks_.raw().wait_for_readers(1, patience));
    // The writer knows of a match before the reader does: of a drive that comes in one moment the
    // first seconds would be over before their odometry, for which scans do not wait longer.
    odometry_.publish(convert::to_odometry({}, {}, "odom", "base_link"));
    EXPECT_TRUE(says("received /odom", "1"));
  }
  /// odometry_began: where its odometry was zero.
  void drive(const std::vector<test::Moment>& moments, const Pose2& odometry_began = {}) {
    for (const test::Moment& moment : moments) {
      const Scan scan = test::scan_at(moment);
      odometry_.publish(convert::to_odometry(scan.stamp, between(odometry_began, moment.pose),
                                             "odom", "base_link"));
      scans_.publish(convert::to_message(scan, "laser"));
    }
  }
  void mark(double time_s) { landmarks_.publish(landmark_at(time_s)); }
  /// The value of a status that has it, with the given value.
  [[nodiscard]] bool says(const std::string& key, const std::string& value) {
    return test::value_of(watch_.wait_for(*host_,
                                          [&](const auto& status) {
                                            return test::value_of(status, key) == value;
                                          }),
                          key) == value;
  }
  /// What a status warns of.
  [[nodiscard]] std::string warning() {
    return watch_
        .wait_for(*host_,
                  [](const auto& status) {
                    return status.level() == static_cast<std::uint8_t>(runtime::HealthLevel::kWarn);
                  })
        .message();
  }
  /// Whether a status has it with another value than 0.
  [[nodiscard]] bool counts(const std::string& key) {
    const auto is_some = [&](const auto& status) {
      const std::string value = test::value_of(status, key);
      return !value.empty() && value != "0";
    };
    return is_some(watch_.wait_for(*host_, is_some));
  }
  [[nodiscard]] std::vector<Topologies> wait_for(std::size_t count) {
    return topologies_.wait_for(count);
  }
  [[nodiscard]] std::vector<Topologies> seen_by_a_late_joiner() {
    test::Collector<Topologies> late(test::make_participant(), "/topologies", "latched");
    return late.wait_for(1);
  }
  void end() { host_.reset(); }
  [[nodiscard]] runtime::Host& host() { return *host_; }

 private:
  std::shared_ptr<bus::Participant> participant_;
  test::StatusWatch watch_;
  test::Collector<Topologies> topologies_;
  bus::Writer<sensor_msgs::msg::LaserScan> scans_;
  bus::Writer<nav_msgs::msg::Odometry> odometry_;
  bus::Writer<PointStamped> landmarks_;
  bus::Writer<tf2_msgs::msg::TFMessage> tf_static_;
  runtime::Registry registry_;
  std::unique_ptr<runtime::Host> host_;
};

}  // namespace strata::topology_mapper
