// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sensor_component.hpp"

#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

/// Odometry comes often, and what is lost of it moves scans: it waits while a map is made.
constexpr int kWaitingOdometry = 1000;

}  // namespace

void SensorComponent::subscribe_sensors(const SensorInputConfig& wanted, const std::string& qos,
                                        const std::string& published_odometry_frame) {
  SensorInputConfig config = wanted;
  if (lockstep()) {
    // The player sends the scans of all scanners there, each in a frame of its own.
    config.scan_topics.clear();
    config.cloud_topics.clear();
  }
  input_.emplace(config, !lockstep());
  stamps_ = {};
  published_odometry_frame_ = log::frame_name(published_odometry_frame);
  is_set_back_ = false;
  subscribe<tf2_msgs::msg::TFMessage>("/tf_static", "tf_static", [this](const auto& message) {
    input_->add(message);
    take_observations();
  });
  if (!lockstep() && !config.tf_odometry_frame.empty()) {
    subscribe<tf2_msgs::msg::TFMessage>("/tf", "tf",
                                        [this](const auto& message) {
                                          input_->add_moving(message);
                                          take_observations();
                                        },
                                        {.min_waiting = kWaitingOdometry});
  }
  subscribe<nav_msgs::msg::Odometry>(config.odometry_topic, qos,
                                     [this, topic = config.odometry_topic](const auto& message) {
                                       input_->add(message);
                                       compare_frames(message, topic);
                                       // In lockstep the scan comes after its odometry.
                                       if (!lockstep()) take_observations();
                                     },
                                     {.min_waiting = kWaitingOdometry});
  const std::vector<std::string> topics = config.all_scan_topics();
  const std::size_t lasers = config.laser_topics().size();
  for (std::size_t topic = 0; topic < topics.size(); ++topic) {
    const auto add = [this, topic](const auto& message) {
      input_->add(message, topic);
      take_observations();
    };
    if (topic < lasers) {
      subscribe<sensor_msgs::msg::LaserScan>(topics[topic], qos, add);
    } else {
      subscribe<sensor_msgs::msg::PointCloud2>(topics[topic], qos, add);
    }
  }
}

void SensorComponent::compare_frames(const nav_msgs::msg::Odometry& message,
                                     const std::string& topic) {
  if (lockstep() || published_odometry_frame_.empty()) return;
  const std::string frame = log::frame_name(message.header().frame_id());
  if (frame.empty() || frame == published_odometry_frame_) return;
  const std::string published = std::exchange(published_odometry_frame_, "");  // told once
  tell(InputError(resolve(topic),
                  "is in the frame " + frame + ", and the map's transform is to " + published,
                  "set odometry_frame to the frame that /tf moves the robot in"));
}

void SensorComponent::take_observations() {
  const std::vector<Observation> observations = input_->take();
  const std::optional<std::size_t> by_old_clock = input_->take_set_back();
  is_set_back_ = is_set_back_ || by_old_clock;
  const auto tell_warnings = [this] {
    for (const std::string& warning : input_->take_warnings()) tell(std::runtime_error(warning));
  };
  tell_warnings();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& observation = observations[i];
    if (is_set_back_ && i >= by_old_clock.value_or(0)) tell_set_back();
    if (lockstep() || stamps_.believes(observation.scan.stamp)) {
      on_observation(observation);
    } else {
      tell(InputError("scan", "a stamp lies further than a minute ahead of the one before",
                      "see what publishes it; after a gap the next scan is taken"));
    }
  }
  for (const Observation& observation : observations) input_->watch_clock(observation);
  tell_warnings();
}

void SensorComponent::tell_set_back() {
  is_set_back_ = false;
  tell(InputError("scan", "the clock of the scans was set back",
                  "keep clocks in step; " + on_clock_set_back()));
}

void SensorComponent::diagnose_input(Health& health) const {
  if (input_) input_->diagnose(health);
}

}  // namespace strata::runtime
