// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/restore_point.hpp"

#include <algorithm>

#include "components/convert/geometry_messages.hpp"
#include "components/runtime/parameters.hpp"
#include "core/base/error.hpp"

namespace strata::localizer {
namespace {

using rcl_interfaces::msg::ParameterValue;
using runtime::parameter_value;

/// rcl_interfaces/ParameterType's number of bytes, which no parameter of ours is.
constexpr std::uint8_t kBytes = 5;

ParameterValue bytes_value(const std::vector<std::uint8_t>& bytes) {
  ParameterValue value;
  value.type(kBytes);
  value.byte_array_value(bytes);
  return value;
}

/// Numbers of 64 bits without a sign, in the message's with one.
std::int64_t as_signed(std::uint64_t number) { return static_cast<std::int64_t>(number); }
std::uint64_t as_unsigned(std::int64_t number) { return static_cast<std::uint64_t>(number); }

const ParameterValue& value_of(const rcl_interfaces::msg::ParameterEvent& message,
                               const std::string& name, std::uint8_t type) {
  const auto& all = message.new_parameters();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name() == name; });
  if (found == all.end() || found->value().type() != type) {
    throw InputError("restore point of " + message.node(), "has no " + name,
                     "replay it with the version of Strata that recorded it");
  }
  return found->value();
}

std::uint8_t number_of(runtime::ParameterType type) { return static_cast<std::uint8_t>(type); }

}  // namespace

rcl_interfaces::msg::ParameterEvent to_message(const RestorePoint& point) {
  rcl_interfaces::msg::ParameterEvent message;
  message.stamp(convert::to_message(point.stamp));
  message.node(point.localizer);
  message.new_parameters({
      runtime::parameter("next_scan", parameter_value(as_signed(point.next_scan))),
      runtime::parameter("goes_on", parameter_value(point.goes_on)),
      runtime::parameter("seed", parameter_value(as_signed(point.seed))),
      runtime::parameter("settings", parameter_value(point.settings)),
      runtime::parameter("maps", parameter_value(point.maps)),
      runtime::parameter("maps_sha256", parameter_value(point.maps_sha256)),
      runtime::parameter("map_messages", parameter_value(to_text(point.map_messages))),
      runtime::parameter("state", bytes_value(point.state)),
  });
  return message;
}

RestorePoint restore_point(const rcl_interfaces::msg::ParameterEvent& message) {
  using Type = runtime::ParameterType;
  const auto number = [&](const char* name) {
    return as_unsigned(value_of(message, name, number_of(Type::kInteger)).integer_value());
  };
  const auto text = [&](const char* name) {
    return value_of(message, name, number_of(Type::kString)).string_value();
  };
  RestorePoint point;
  point.localizer = message.node();
  point.stamp = convert::from_message(message.stamp());
  point.next_scan = number("next_scan");
  point.goes_on = value_of(message, "goes_on", number_of(Type::kBool)).bool_value();
  point.seed = number("seed");
  point.settings = text("settings");
  point.maps = text("maps");
  point.maps_sha256 = text("maps_sha256");
  point.map_messages = map_messages(text("map_messages"));
  point.state = value_of(message, "state", kBytes).byte_array_value();
  return point;
}

}  // namespace strata::localizer
