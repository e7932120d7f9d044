// SPDX-License-Identifier: Apache-2.0
/// The fields of a recorded message, named and in order, by the .msg text of its type: what a
/// comparison needs to say where two messages differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace strata::log {

/// A number (all integers, floats and booleans) or a text.
struct FieldValue {
  double number = 0.0;
  std::string text;
  bool is_text = false;
};

/// The values of all fields of a CDR message, nested ones and the items of arrays in order; the
/// length of a sequence is a value of its own before its items. Nothing when message_definition
/// does not know the type. Throws InputError for bytes that do not fit the type. O(bytes).
[[nodiscard]] std::optional<std::vector<FieldValue>> message_fields(
    const std::string& type, std::span<const std::uint8_t> cdr);

/// "pose.pose.position.x" or "ranges[17]" or "ranges.length" for the value at `index` of
/// message_fields; empty when there is none.
[[nodiscard]] std::string field_path(const std::string& type, std::span<const std::uint8_t> cdr,
                                     std::size_t index);

}  // namespace strata::log
