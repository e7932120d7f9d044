// SPDX-License-Identifier: Apache-2.0
#include "components/player/conducted_outputs.hpp"

#include "components/bus/names.hpp"

namespace strata::player {

Outputs conducted_outputs(runtime::LockstepCoordinator& coordinator, const std::string& scope,
                          bool with_poses) {
  const auto named = [&](const std::string& topic) {
    return bus::expand_name(topic, scope, "player");
  };
  Outputs outputs;
  outputs.clock = coordinator.advertise<rosgraph_msgs::msg::Clock>("/clock");
  outputs.tf_static = coordinator.advertise<tf2_msgs::msg::TFMessage>("/tf_static");
  outputs.tf = coordinator.advertise<tf2_msgs::msg::TFMessage>("/tf");
  outputs.odometry = coordinator.advertise<nav_msgs::msg::Odometry>(named("odom"));
  outputs.scan = coordinator.advertise<sensor_msgs::msg::LaserScan>(named("scan"));
  if (with_poses) {
    outputs.given_pose = coordinator.advertise<strata_msgs::msg::ScanPose>(named("given_pose"));
  }
  return outputs;
}

}  // namespace strata::player
