// SPDX-License-Identifier: Apache-2.0
/// Messages as ROS 1 serialized them, into those of ROS 2, which the rest of Strata reads.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "components/convert/message_definitions.hpp"
#include "components/log/compression.hpp"

namespace strata::log {

/// What a ROS 1 type becomes.
struct Ros1Type {
  std::string ros2_type;  ///< "sensor_msgs/msg/LaserScan"
  const convert::MessageLayout* layout = nullptr;
};

/// type: "sensor_msgs/LaserScan". md5: of its definition as the bag states it; "*" fits any.
/// Nothing for types that are not known, or that are known by another definition.
[[nodiscard]] std::optional<Ros1Type> find_ros1_type(std::string_view type, std::string_view md5);

/// "pkg/Type" as ROS 2 writes it, "pkg/msg/Type".
[[nodiscard]] std::string ros2_type_name(std::string_view type);

/// The message as little-endian CDR with its header of 4 bytes, to the bit as convert::to_cdr makes
/// it; a Header's seq, which ROS 2 has not, is left out. Throws convert::Undecodable(place, ...)
/// when the bytes are not a message of the type: too few, too many, or a time that ROS 2 cannot
/// state (2038 and later). O(bytes).
[[nodiscard]] Bytes ros1_to_cdr(const Ros1Type& type, View message, const std::string& place);

}  // namespace strata::log
