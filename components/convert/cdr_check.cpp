// SPDX-License-Identifier: Apache-2.0
#include "components/convert/cdr_check.hpp"

#include <cstddef>

namespace strata::convert {
namespace {

/// Walks over a message by its layout; alignment counts from behind the header.
class Walker {
 public:
  explicit Walker(std::span<const std::uint8_t> bytes)
      : body_(bytes.subspan(4)), little_(bytes[1] == 1) {}

  [[nodiscard]] bool ok() const { return ok_; }
  /// Reads a uint32.
  std::uint32_t number() {
    align(4);
    if (!has(4)) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      value |= static_cast<std::uint32_t>(body_[at_ + (little_ ? i : 3 - i)]) << (8 * i);
    }
    at_ += 4;
    return value;
  }
  void skip(std::size_t count, std::size_t size) {
    if (count == 0) return;
    align(size);
    if (count > body_.size() / size || !has(count * size)) {
      ok_ = false;
      return;
    }
    at_ += count * size;
  }
  void text() { skip(number(), 1); }
  /// Nothing but padding is left.
  [[nodiscard]] bool at_end() const { return ok_ && at_ <= body_.size() && body_.size() - at_ < 4; }
  void gids(std::size_t gid_bytes) {
    const std::uint32_t count = number();
    for (std::uint32_t i = 0; i < count && ok_; ++i) skip(gid_bytes, 1);
  }
  void header() {
    skip(2, 4);
    text();
  }

 private:
  void align(std::size_t size) { at_ = (at_ + size - 1) / size * size; }
  [[nodiscard]] bool has(std::size_t bytes) {
    if (at_ > body_.size() || bytes > body_.size() - at_) ok_ = false;
    return ok_;
  }

  std::span<const std::uint8_t> body_;
  bool little_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

bool graph_fits(std::span<const std::uint8_t> bytes, std::size_t gid_bytes) {
  Walker walk(bytes);
  walk.skip(gid_bytes, 1);
  const std::uint32_t count = walk.number();
  for (std::uint32_t i = 0; i < count && walk.ok(); ++i) {
    walk.text();
    walk.text();
    walk.gids(gid_bytes);
    walk.gids(gid_bytes);
  }
  return walk.at_end();
}

}  // namespace

template <>
bool sequences_fit<rmw_dds_common::msg::ParticipantEntitiesInfo>(
    std::span<const std::uint8_t> bytes) {
  return graph_fits(bytes, 16);
}

template <>
bool sequences_fit<rmw_dds_common_24::msg::ParticipantEntitiesInfo>(
    std::span<const std::uint8_t> bytes) {
  return graph_fits(bytes, 24);
}

template <>
bool sequences_fit<sensor_msgs::msg::LaserScan>(std::span<const std::uint8_t> bytes) {
  Walker walk(bytes);
  walk.header();
  walk.skip(7, 4);
  walk.skip(walk.number(), 4);
  walk.skip(walk.number(), 4);
  return walk.ok();
}

template <>
bool sequences_fit<nav_msgs::msg::Odometry>(std::span<const std::uint8_t> bytes) {
  Walker walk(bytes);
  walk.header();
  walk.text();
  walk.skip(7 + 36 + 6 + 36, 8);
  return walk.ok();
}

template <>
bool sequences_fit<tf2_msgs::msg::TFMessage>(std::span<const std::uint8_t> bytes) {
  Walker walk(bytes);
  const std::uint32_t count = walk.number();
  for (std::uint32_t i = 0; i < count && walk.ok(); ++i) {
    walk.header();
    walk.text();
    walk.skip(7, 8);
  }
  return walk.ok();
}

}  // namespace strata::convert
