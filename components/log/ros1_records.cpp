// SPDX-License-Identifier: Apache-2.0
#include "components/log/ros1_records.hpp"

#include <algorithm>
#include <limits>

#include "core/base/error.hpp"

namespace strata::log {

void require_ros1_format(View start, const std::string& name) {
  const std::string magic(start.begin(), start.end());
  if (magic.starts_with(kRos1Magic)) return;
  if (kRos1Magic.starts_with(magic)) {
    throw InputError(name + ": byte " + std::to_string(magic.size()), "the file is cut here",
                     "check that it was copied whole");
  }
  throw InputError(
      name,
      "is a ROS 1 bag of another format (" + magic.substr(0, magic.find('\n')) +
          "), and only 2.0 can be read",
      "have ROS 1 record it anew: `rosbag record` while `rosbag play OLD.bag` plays it");
}

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

std::uint64_t ros1_index_begin_ns(View data) {
  std::uint64_t begin_ns = std::numeric_limits<std::uint64_t>::max();
  ByteCursor cursor(data);
  while (cursor.left() >= 12) {
    const Stamp stamp = ros1_time(cursor.number<std::uint64_t>());
    cursor.number<std::uint32_t>();  // the place in the chunk
    begin_ns = std::min(begin_ns, static_cast<std::uint64_t>(stamp.ns));
  }
  return begin_ns;
}

}  // namespace strata::log
