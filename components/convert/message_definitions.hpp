// SPDX-License-Identifier: Apache-2.0
/// What the messages of idl/ look like, made from the IDL itself, so that it cannot differ from
/// what is on the wire.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace strata::convert {

/// The .msg text of a type ("std_msgs/msg/Header") with its dependencies, as MCAP and rosbag2 keep
/// it for viewers to decode messages with; empty for types we do not know.
[[nodiscard]] std::string message_definition(std::string_view type);

/// The fields of a message in order, as its bytes follow one another.
struct MessageLayout {
  struct Field {
    std::size_t size = 0;                 ///< of a scalar in bytes; 0 for strings and messages
    const MessageLayout* part = nullptr;  ///< of a message inside; null with size 0: a string
    bool is_sequence = false;             ///< its length comes first
    std::size_t count = 1;                ///< of an array
  };
  std::vector<Field> fields;
};
/// Null for types we do not know. Lives as long as the program.
[[nodiscard]] const MessageLayout* message_layout(std::string_view type);

}  // namespace strata::convert
