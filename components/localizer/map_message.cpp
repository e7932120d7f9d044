// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/map_message.hpp"

#include <sstream>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/strata_msgs.h"

namespace strata::localizer {
namespace {

/// An empty field would be none.
constexpr const char* kUnknown = "-";

template <typename Message>
bool fill(std::optional<MapMessage>& found, const std::string& topic, const std::string& type,
          const std::vector<std::uint8_t>& cdr) {
  if (type != bus::MessageType<Message>::name) return false;
  found = map_message(topic, convert::from_cdr<Message>(cdr, topic));
  return true;
}

}  // namespace

std::optional<MapMessage> map_message(const std::string& topic, const std::string& type,
                                      const std::vector<std::uint8_t>& cdr) {
  std::optional<MapMessage> found;
  (void)(fill<nav_msgs::msg::OccupancyGrid>(found, topic, type, cdr) ||
         fill<strata_msgs::msg::ReflectionGrid>(found, topic, type, cdr) ||
         fill<strata_msgs::msg::PatchMap>(found, topic, type, cdr) ||
         fill<strata_msgs::msg::NodeMap>(found, topic, type, cdr));
  return found;
}

std::string to_text(const std::vector<MapMessage>& messages) {
  std::string text;
  for (const MapMessage& message : messages) {
    text += message.topic + " " + message.type + " " +
            (message.sha256.empty() ? kUnknown : message.sha256) + "\n";
  }
  return text;
}

std::vector<MapMessage> map_messages(const std::string& text) {
  std::vector<MapMessage> messages;
  std::istringstream lines(text);
  for (MapMessage one; lines >> one.topic >> one.type >> one.sha256;) {
    if (one.sha256 == kUnknown) one.sha256.clear();
    messages.push_back(one);
  }
  return messages;
}

}  // namespace strata::localizer
