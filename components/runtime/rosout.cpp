// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/rosout.hpp"

#include <algorithm>
#include <utility>

#include "components/convert/geometry_messages.hpp"

namespace strata::runtime {
namespace {

/// "robot1.localizer" of "/robot1/localizer".
std::string logger_name(const std::string& node) {
  std::string name = node.substr(std::min(node.find_first_not_of('/'), node.size()));
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

}  // namespace

Rosout::Rosout(std::shared_ptr<bus::Participant> participant, const std::string& node,
               const std::string& topic)
    : name_(logger_name(node)),
      writer_(std::move(participant), topic, bus::qos_profile("rosout")) {}

void Rosout::log(LogLevel level, const std::string& text, Stamp stamp) {
  rcl_interfaces::msg::Log message;
  message.stamp(convert::to_message(stamp));
  message.level(static_cast<std::uint8_t>(level));
  message.name(name_);
  message.msg(text);
  writer_.publish(message);
}

void Rosout::warn(const Health& health, const std::string& said, Stamp stamp) {
  std::set<std::string> now(health.complaints().begin(), health.complaints().end());
  now.erase(said);
  const std::set<std::string> before = std::exchange(complaints_, now);
  for (const std::string& complaint : now) {
    if (!before.contains(complaint)) log(LogLevel::kWarn, complaint, stamp);
  }
}

}  // namespace strata::runtime
