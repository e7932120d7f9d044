// SPDX-License-Identifier: Apache-2.0
/// Whether the lengths inside a serialized message fit into it.
///
/// Fast CDR 1 makes room for a sequence as long as the bytes claim before it looks whether they are
/// there: one flipped bit, in a file or on the wire, would take gigabytes. So the lengths are
/// walked over first, by the layout that the IDL says.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "components/convert/message_definitions.hpp"

namespace rmw_dds_common::msg {
class ParticipantEntitiesInfo;
}
namespace rmw_dds_common_24::msg {
class ParticipantEntitiesInfo;
}

namespace strata::convert {

enum class LayoutFit {
  kTooShort,    ///< the lengths inside say more than is there
  kExact,       ///< nothing but padding is left
  kMoreBehind,  ///< as from a newer type
};
/// bytes: with the header of 4 bytes, of plain CDR. O(fields and strings).
[[nodiscard]] LayoutFit fit(const MessageLayout& layout, std::span<const std::uint8_t> bytes);

/// "strata_msgs/msg/Pose2" of the generated class strata_msgs::msg::Pose2.
template <typename Message>
[[nodiscard]] std::string message_type() {
  constexpr std::string_view key = "Message = ";
  const std::string_view function = __PRETTY_FUNCTION__;  // "... [with Message = a::msg::B; ..."
  const std::size_t begin = function.find(key) + key.size();
  const std::string_view name = function.substr(begin, function.find_first_of(";]", begin) - begin);
  std::string type;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool scope = name[i] == ':';
    if (scope) ++i;
    type += scope ? '/' : name[i];
  }
  return type;
}

/// Types that are not in idl/ are trusted.
template <typename Message>
[[nodiscard]] bool sequences_fit(std::span<const std::uint8_t> bytes) {
  static const MessageLayout* const layout = message_layout(message_type<Message>());
  return layout == nullptr || fit(*layout, bytes) != LayoutFit::kTooShort;
}
/// These two say whether the bytes end where the content does: the same type name stands for both.
template <>
[[nodiscard]] inline bool sequences_fit<rmw_dds_common::msg::ParticipantEntitiesInfo>(
    std::span<const std::uint8_t> bytes) {
  return fit(*message_layout("rmw_dds_common/msg/ParticipantEntitiesInfo"), bytes) ==
         LayoutFit::kExact;
}
template <>
[[nodiscard]] inline bool sequences_fit<rmw_dds_common_24::msg::ParticipantEntitiesInfo>(
    std::span<const std::uint8_t> bytes) {
  return fit(*message_layout("rmw_dds_common_24/msg/ParticipantEntitiesInfo"), bytes) ==
         LayoutFit::kExact;
}

}  // namespace strata::convert
