// SPDX-License-Identifier: Apache-2.0
/// The records that ROS 1 bags of format 2.0 are made of (http://wiki.ros.org/Bags/Format/2.0): the
/// length of a header, the header, the length of the data, the data.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "components/log/byte_cursor.hpp"
#include "components/log/compression.hpp"
#include "core/base/time.hpp"

namespace strata::log {

constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";
/// Throws InputError unless these are the first bytes of a bag of format 2.0 (20 tell enough).
/// name: of the file.
void require_ros1_format(View start, const std::string& name);

/// With its lengths; what it does not need is filled with spaces.
constexpr std::uint64_t kRos1BagHeaderBytes = 4104;

enum class Ros1Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// NAME=VALUE, each with its length before it, in any order.
class Ros1Fields {
 public:
  Ros1Fields() = default;
  explicit Ros1Fields(View bytes);

  /// Whether they are such fields, and no bytes are left.
  [[nodiscard]] bool ok() const { return ok_; }
  /// Empty when there is none of that name.
  [[nodiscard]] std::string text(const std::string& name) const;
  /// Nothing when there is none of that name and length.
  template <typename T>
  [[nodiscard]] std::optional<T> number(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end() || found->second.size() != sizeof(T)) return std::nullopt;
    return ByteCursor(found->second).number<T>();
  }
  [[nodiscard]] std::optional<Ros1Op> op() const;
  /// Two numbers of 4 bytes: seconds and nanoseconds.
  [[nodiscard]] std::optional<Stamp> time(const std::string& name) const;

 private:
  std::map<std::string, Bytes> values_;
  bool ok_ = true;
};

[[nodiscard]] Stamp ros1_time(std::uint64_t time);

/// When the oldest message was recorded of those that the data of an index record tell, which are
/// one connection's in the chunk before it; the largest number where it tells none. O(bytes).
[[nodiscard]] std::uint64_t ros1_index_begin_ns(View data);

/// Calls visit(fields, data) for every record of a chunk's content; false when it ends in one.
template <typename Visit>
bool for_each_ros1_record(View content, Visit&& visit) {
  ByteCursor cursor(content);
  while (cursor.left() > 0) {
    const Ros1Fields fields(cursor.take(cursor.number<std::uint32_t>()));
    const View data = cursor.take(cursor.number<std::uint32_t>());
    if (!cursor.ok() || !fields.ok()) return false;
    visit(fields, data);
  }
  return true;
}

}  // namespace strata::log
