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
  /// Live: the scan that on_observation is called with next is `by_s` older than the last one, and
  /// those that follow it are, too. It is told already.
  virtual void on_clock_set_back(double by_s) { (void)by_s; }

 private:
  void take_observations();
  void watch_set_back(Stamp stamp);
  std::optional<SensorInput> input_;
  StampWatch stamps_;
  std::optional<Stamp> newest_;  ///< of the scans that went on
};

}  // namespace strata::runtime
