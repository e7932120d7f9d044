// SPDX-License-Identifier: Apache-2.0
/// Messages that maps came with, told apart by their contents.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "components/bus/message_types.hpp"
#include "components/convert/cdr.hpp"
#include "components/log/sha256.hpp"

namespace strata::localizer {

/// Of which message a part of the maps was made.
struct MapMessage {
  std::string topic;   ///< "/patch_map"
  std::string type;    ///< "strata_msgs/msg/PatchMap"
  std::string sha256;  ///< of what is in it; empty: more than this message made the part
  friend bool operator==(const MapMessage&, const MapMessage&) = default;
};

/// O(bytes): a millisecond for some hundred kB.
template <typename Message>
[[nodiscard]] MapMessage map_message(const std::string& topic, const Message& message) {
  // Encoded here: who sent it may lay out the same otherwise.
  const std::vector<std::uint8_t> cdr = convert::to_cdr(message);
  const auto* text = reinterpret_cast<const char*>(cdr.data());
  return {topic, bus::MessageType<Message>::name, log::sha256_of({text, cdr.size()})};
}

/// The same of a recorded one; nothing when its type is none of maps. Throws InputError for damaged
/// bytes.
[[nodiscard]] std::optional<MapMessage> map_message(const std::string& topic,
                                                    const std::string& type,
                                                    const std::vector<std::uint8_t>& cdr);

/// A line each, and back; lines that are none are left out.
[[nodiscard]] std::string to_text(const std::vector<MapMessage>& messages);
[[nodiscard]] std::vector<MapMessage> map_messages(const std::string& text);

}  // namespace strata::localizer
