// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sensor_component.hpp"

namespace strata::runtime {

void SensorComponent::subscribe_sensors(const SensorInputConfig& config, const std::string& qos) {
  input_.emplace(config, !lockstep());
  subscribe<tf2_msgs::msg::TFMessage>("/tf_static", "tf_static", [this](const auto& message) {
    input_->add(message);
    take_observations();
  });
  if (!lockstep() && !config.tf_odometry_frame.empty()) {
    subscribe<tf2_msgs::msg::TFMessage>("/tf", "tf", [this](const auto& message) {
      input_->add_moving(message);
      take_observations();
    });
  }
  subscribe<nav_msgs::msg::Odometry>(config.odometry_topic, qos, [this](const auto& message) {
    input_->add(message);
    // In lockstep the scan comes after its odometry.
    if (!lockstep()) take_observations();
  });
  subscribe<sensor_msgs::msg::LaserScan>(config.scan_topic, qos, [this](const auto& message) {
    input_->add(message);
    take_observations();
  });
}

void SensorComponent::take_observations() {
  for (const Observation& observation : input_->take()) on_observation(observation);
}

}  // namespace strata::runtime
