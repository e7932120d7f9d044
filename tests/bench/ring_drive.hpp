// SPDX-License-Identifier: Apache-2.0
/// A robot that drives round a block and tells on DDS what it sees.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "components/bus/endpoint.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/components/runtime/laser_mounting.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::bench {

inline constexpr int kBeams = 1'080;
inline constexpr auto kPeriod = std::chrono::milliseconds(25);

/// Once and a half round a block, so that a loop closes on the way.
inline std::vector<Observation> ring_log(int beams = kBeams) {
  const std::vector<Pose2> path = test::drive_round(0.0175, 60.0);  // 0.7 m/s
  std::vector<Observation> log;
  for (std::size_t i = 0; i < path.size(); ++i) {
    Observation observation;
    observation.scan = test::scan_of(test::ring(), path[i], 1.0 + 0.025 * static_cast<double>(i),
                                     0.01, 1, beams, 1.5 * std::numbers::pi);
    observation.odom_from_robot = path[i];
    log.push_back(std::move(observation));
  }
  return log;
}

struct Robot {
  /// scope: of its topics, "" or "/robot1".
  explicit Robot(std::shared_ptr<bus::Participant> own = test::make_participant(),
                 const std::string& scope = "", const char* scan_qos = "sensor_data")
      : participant(std::move(own)),
        scans(participant, scope + "/scan", bus::qos_profile(scan_qos)),
        odometry(participant, scope + "/odom", bus::qos_profile("sensor_data")) {}
  std::shared_ptr<bus::Participant> participant;
  bus::Writer<sensor_msgs::msg::LaserScan> scans;
  bus::Writer<nav_msgs::msg::Odometry> odometry;
  bus::Writer<tf2_msgs::msg::TFMessage> mounting{participant, "/tf_static",
                                                 bus::qos_profile("latched")};
  /// Where the laser sits; publish it before the first scan.
  void tell_mounting() { mounting.publish(test::laser_mounting()); }
  [[nodiscard]] bool is_heard() {
    return scans.raw().wait_for_readers(1, std::chrono::seconds(20)) &&
           odometry.raw().wait_for_readers(1, std::chrono::seconds(20));
  }
  /// Tells odometry and scan; when the scan, ready made, was handed to the middleware.
  std::chrono::steady_clock::time_point see(const Observation& observation) {
    const auto scan = convert::to_message(observation.scan, "laser");
    nav_msgs::msg::Odometry message;
    message.header().stamp(convert::to_message(observation.scan.stamp));
    message.header().frame_id("odom");
    message.child_frame_id("base_link");
    message.pose().pose().position().x(observation.odom_from_robot.x);
    message.pose().pose().position().y(observation.odom_from_robot.y);
    message.pose().pose().orientation().z(std::sin(0.5 * observation.odom_from_robot.theta));
    message.pose().pose().orientation().w(std::cos(0.5 * observation.odom_from_robot.theta));
    odometry.publish(message);
    const auto handed_over = std::chrono::steady_clock::now();
    scans.publish(scan);
    return handed_over;
  }
};

inline void tell(benchmark::State& state, std::vector<double> each_ms) {
  std::sort(each_ms.begin(), each_ms.end());
  const auto at = [&](double share) {
    return each_ms[static_cast<std::size_t>(share * static_cast<double>(each_ms.size() - 1))];
  };
  state.counters["median_ms"] = at(0.5);
  state.counters["p95_ms"] = at(0.95);
  state.counters["p99_ms"] = at(0.99);
  state.counters["max_ms"] = at(1.0);
  state.counters["scans"] = static_cast<double>(each_ms.size());
}

}  // namespace strata::bench
