// SPDX-License-Identifier: Apache-2.0
/// Whether the lengths inside a serialized message fit into it.
///
/// Fast CDR 1 makes room for a sequence as long as the bytes claim before it looks whether they are
/// there: one flipped bit in a file would take gigabytes. Types that are read from files have a
/// check here that walks over the lengths first.
#pragma once

#include <cstdint>
#include <span>

namespace nav_msgs::msg {
class Odometry;
}
namespace rmw_dds_common::msg {
class ParticipantEntitiesInfo;
}
namespace rmw_dds_common_24::msg {
class ParticipantEntitiesInfo;
}
namespace sensor_msgs::msg {
class LaserScan;
}
namespace tf2_msgs::msg {
class TFMessage;
}

namespace strata::convert {

/// Types without a specialization are trusted (they come from our own process or from DDS).
template <typename Message>
[[nodiscard]] inline bool sequences_fit(std::span<const std::uint8_t> /*bytes*/) {
  return true;
}
template <>
[[nodiscard]] bool sequences_fit<sensor_msgs::msg::LaserScan>(std::span<const std::uint8_t> bytes);
template <>
[[nodiscard]] bool sequences_fit<nav_msgs::msg::Odometry>(std::span<const std::uint8_t> bytes);
template <>
[[nodiscard]] bool sequences_fit<tf2_msgs::msg::TFMessage>(std::span<const std::uint8_t> bytes);
/// These two say whether the bytes end where the content does: the same type name stands for both.
template <>
[[nodiscard]] bool sequences_fit<rmw_dds_common::msg::ParticipantEntitiesInfo>(
    std::span<const std::uint8_t> bytes);
template <>
[[nodiscard]] bool sequences_fit<rmw_dds_common_24::msg::ParticipantEntitiesInfo>(
    std::span<const std::uint8_t> bytes);

}  // namespace strata::convert
