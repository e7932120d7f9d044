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
  /// qos: profile of odometry and scans. What the input complains of is told, once each; so is
  /// odometry of another frame than the transform that is published has, as then nothing connects
  /// the map to the robot. published_odometry_frame: empty where none is published.
  void subscribe_sensors(const SensorInputConfig& config, const std::string& qos,
                         const std::string& published_odometry_frame = "");
  /// For on_diagnose: what the input has to say.
  void diagnose_input(Health& health) const;
  /// As SensorInput's.
  [[nodiscard]] std::optional<Pose2> moved_since(Stamp stamp) const {
    return input_ ? input_->moved_since(stamp) : std::nullopt;
  }
  /// Each scan once, with its odometry and mounting, in order.
  virtual void on_observation(const Observation& observation) = 0;
  /// Live: the clock of a scanner was set back, and on_observation is called with its first scan
  /// by the new one next. Returns what people are to be told of what comes of it.
  [[nodiscard]] virtual std::string on_clock_set_back() { return "what is learned goes on"; }

 private:
  void take_observations();
  void compare_frames(const nav_msgs::msg::Odometry& message, const std::string& topic);
  void tell_set_back();
  std::optional<SensorInput> input_;
  StampWatch stamps_;
  std::string published_odometry_frame_;
  bool is_set_back_ = false;  ///< and no scan by the new clock has gone on
};

}  // namespace strata::runtime
