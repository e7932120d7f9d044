// SPDX-License-Identifier: Apache-2.0
/// What components that work on scans with odometry have in common.
#pragma once

#include <optional>
#include <string>

#include "components/runtime/component.hpp"
#include "components/runtime/sensor_input.hpp"
#include "components/runtime/stamp_watch.hpp"

namespace strata::runtime {

class SensorComponent : public Component {
 public:
  using Component::Component;

 protected:
  /// Subscribes /tf_static, odometry, live also /tf, and scans of every scanner; for on_configure.
  /// qos: profile of odometry and scans. What the input complains of is told, once each.
  void subscribe_sensors(const SensorInputConfig& config, const std::string& qos);
  /// For on_diagnose: what the input has to say.
  void diagnose_input(Health& health) const;
  /// Each scan once, with its odometry and mounting, in order.
  virtual void on_observation(const Observation& observation) = 0;

 private:
  void take_observations();
  std::optional<SensorInput> input_;
  StampWatch stamps_;
};

}  // namespace strata::runtime
