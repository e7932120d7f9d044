// SPDX-License-Identifier: Apache-2.0
/// Parts of what viewers send, which may be anything.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace strata::live_view {

/// A number of 32 bits without sign; nothing for all else.
[[nodiscard]] inline std::optional<std::uint32_t> number_of(const nlohmann::json& json) {
  if (!json.is_number_unsigned()) return std::nullopt;
  const auto value = json.get<std::uint64_t>();
  if (value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

/// ... of an object's member.
[[nodiscard]] inline std::optional<std::uint32_t> number_of(const nlohmann::json& object,
                                                            const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  return found == object.end() ? std::nullopt : number_of(*found);
}

/// Empty where there is no such text.
[[nodiscard]] inline std::string string_of(const nlohmann::json& object, const char* key) {
  if (!object.is_object()) return "";
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

/// Empty where there is no such list. Requires an object.
[[nodiscard]] inline const nlohmann::json& list_of(const nlohmann::json& object, const char* key) {
  static const nlohmann::json none = nlohmann::json::array();
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : none;
}

/// Little-endian, at an offset that is there.
[[nodiscard]] inline std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < sizeof(value); ++i) {
    value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[at + i])) << (8 * i);
  }
  return value;
}

}  // namespace strata::live_view
