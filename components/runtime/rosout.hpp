// SPDX-License-Identifier: Apache-2.0
/// A node's part of /rosout, the log that ROS 2's tools show of all nodes.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>

#include "components/bus/endpoint.hpp"
#include "components/runtime/diagnostics.hpp"
#include "core/base/time.hpp"

namespace strata::runtime {

/// The levels of rcl_interfaces/msg/Log.
enum class LogLevel : std::uint8_t { kDebug = 10, kInfo = 20, kWarn = 30, kError = 40 };

/// Writes one node's messages. Not thread safe: used on the component's mailbox.
class Rosout {
 public:
  /// node: its full name, "/robot1/localizer", which logs as "robot1.localizer".
  /// topic: where it goes, resolved.
  Rosout(std::shared_ptr<bus::Participant> participant, const std::string& node,
         const std::string& topic = "/rosout");

  void log(LogLevel level, const std::string& text, Stamp stamp);
  /// Warns of what `health` complains of and did not the last time; but for `said`, which went out
  /// as an error.
  void warn(const Health& health, const std::string& said, Stamp stamp);

  [[nodiscard]] bus::Guid guid() { return writer_.raw().guid(); }

 private:
  std::string name_;
  std::set<std::string> complaints_;  ///< of the last health
  bus::Writer<rcl_interfaces::msg::Log> writer_;
};

}  // namespace strata::runtime
