// SPDX-License-Identifier: Apache-2.0
/// The sensors of a simulated robot on the bus, at their own pace, whoever listens.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"
#include "components/bus/message_types.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/player/log_player.hpp"
#include "core/random/stream.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::test {

/// Odometry comes four times as often as scans and a little after the scan that it belongs to; some
/// scans and some odometry are lost, and some scans come twice.
class LiveRobot {
 public:
  /// speedup: how many seconds of the robot pass in one of the clock.
  LiveRobot(const std::shared_ptr<bus::Participant>& participant,
            std::vector<simulate::SimulatedScan> scans, double speedup)
      : scans_(participant, "/scan", bus::qos_profile("sensor_data")),
        odometry_(participant, "/odom", bus::qos_profile("default")),
        mountings_(participant, "/tf_static", bus::qos_profile("tf_static")),
        drive_(std::move(scans)),
        player_(observations_of(drive_), outputs(), {}),
        speedup_(speedup) {}

  /// Whether so many hear its scans by then.
  [[nodiscard]] bool is_heard_by(int readers, std::chrono::seconds patience) {
    return scans_.raw().wait_for_readers(readers, patience);
  }
  /// From the scan after the last one to the one before `end`.
  void drive_until(std::size_t end) {
    for (; next_ < end; ++next_) {
      player_.publish(next_);
      const bool is_last = next_ + 1 == drive_.size();
      const Observation& from = drive_[next_].observation;
      const Observation& to = drive_[is_last ? next_ : next_ + 1].observation;
      // A night is waited for a moment only.
      const double step_s = std::min((to.scan.stamp - from.scan.stamp).seconds(), kLongest_s);
      for (int i = 0; i < kOdometryPerScan; ++i) {
        const double t = static_cast<double>(i) / kOdometryPerScan;
        std::this_thread::sleep_for(
            std::chrono::duration<double>(step_s / kOdometryPerScan / speedup_));
        if (random_.bernoulli(kLost)) continue;
        const Stamp stamp = from.scan.stamp + Duration::from_seconds(t * step_s);
        odometry_.publish(convert::to_odometry(
            stamp, interpolate(from.odom_from_robot, to.odom_from_robot, t), "odom", "base_link"));
      }
    }
  }
  [[nodiscard]] std::size_t lost() const { return lost_; }
  [[nodiscard]] std::size_t repeated() const { return repeated_; }

 private:
  static constexpr double kLost = 0.01;
  static constexpr double kLongest_s = 2.0;
  static constexpr int kOdometryPerScan = 4;

  static std::vector<Observation> observations_of(
      const std::vector<simulate::SimulatedScan>& scans) {
    std::vector<Observation> observations;
    for (const simulate::SimulatedScan& scan : scans) observations.push_back(scan.observation);
    return observations;
  }
  player::Outputs outputs() {
    player::Outputs outputs;
    outputs.clock = [](const auto&) {};
    outputs.tf = [](const auto&) {};
    outputs.odometry = [](const auto&) {};  // its own
    outputs.tf_static = [this](const auto& message) { mountings_.publish(message); };
    outputs.scan = [this](const auto& message) {
      if (random_.bernoulli(kLost)) {
        ++lost_;
        return;
      }
      scans_.publish(message);
      if (!random_.bernoulli(kLost)) return;
      ++repeated_;
      scans_.publish(message);
    };
    return outputs;
  }

  bus::Writer<sensor_msgs::msg::LaserScan> scans_;
  bus::Writer<nav_msgs::msg::Odometry> odometry_;
  bus::Writer<tf2_msgs::msg::TFMessage> mountings_;
  std::vector<simulate::SimulatedScan> drive_;
  player::LogPlayer player_;
  double speedup_;
  RandomStream random_{5, StreamId::kTest};
  std::size_t next_ = 0;
  std::size_t lost_ = 0;
  std::size_t repeated_ = 0;
};

}  // namespace strata::test
