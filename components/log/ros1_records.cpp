// SPDX-License-Identifier: Apache-2.0
#include "components/log/ros1_records.hpp"

#include <algorithm>

namespace strata::log {

Ros1Fields::Ros1Fields(View bytes) {
  ByteCursor cursor(bytes);
  while (cursor.left() > 0) {
    const View field = cursor.take(cursor.number<std::uint32_t>());
    const auto equals = std::find(field.begin(), field.end(), '=');
    if (!cursor.ok() || equals == field.end()) {
      ok_ = false;
      return;
    }
    values_[std::string(field.begin(), equals)].assign(equals + 1, field.end());
  }
}

std::string Ros1Fields::text(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) return {};
  return {found->second.begin(), found->second.end()};
}

std::optional<Ros1Op> Ros1Fields::op() const {
  const auto value = number<std::uint8_t>("op");
  if (!value || *value < 2 || *value > 7) return std::nullopt;
  return static_cast<Ros1Op>(*value);
}

std::optional<Stamp> Ros1Fields::time(const std::string& name) const {
  const auto value = number<std::uint64_t>(name);
  return value ? std::optional(ros1_time(*value)) : std::nullopt;
}

Stamp ros1_time(std::uint64_t time) {
  const auto seconds = static_cast<std::int64_t>(time & 0xFFFFFFFFU);
  const auto nanoseconds = static_cast<std::int64_t>(time >> 32U);
  return {seconds * 1'000'000'000 + nanoseconds};
}

}  // namespace strata::log
