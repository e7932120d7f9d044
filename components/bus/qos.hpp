// SPDX-License-Identifier: Apache-2.0
/// Named quality-of-service profiles, the ones that ROS 2 uses for the same topics.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace strata::bus {

/// How a topic is delivered. History is keep-last `depth`, or keep-all when depth is 0.
struct QosProfile {
  std::string name;
  bool reliable = true;          ///< false: best effort
  bool transient_local = false;  ///< late readers get the writer's history
  int depth = 10;
  /// The writer can send its readers a heartbeat when it is asked to (RawWriter::send_heartbeat):
  /// its liveliness is manual, which every reader that asks for no more than ROS 2's default takes.
  bool manual_liveliness = false;
  /// A message that is older is not given to late readers any more; 0: none is too old.
  double lifespan_s = 0.0;

  /// Nothing is ever lost or overwritten: reliable, keep-all, volatile (a latched writer would keep
  /// every message). What lockstep replay uses in place of every profile, once all are matched.
  [[nodiscard]] QosProfile lossless() const;
};

/// "default", "sensor_data", "latched", "tf", "tf_static", "clock", "parameters", "rosout" or
/// "lossless". Throws ConfigError, which lists the names, for another one.
[[nodiscard]] QosProfile qos_profile(std::string_view name);

/// The names qos_profile knows.
[[nodiscard]] std::vector<std::string> qos_profile_names();

}  // namespace strata::bus
