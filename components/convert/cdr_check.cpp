// SPDX-License-Identifier: Apache-2.0
#include "components/convert/cdr_check.hpp"

#include <algorithm>
#include <cstddef>

namespace strata::convert {
namespace {

/// Walks over a message by its layout; alignment counts from behind the header.
class Walker {
 public:
  explicit Walker(std::span<const std::uint8_t> bytes)
      : body_(bytes.subspan(4)), little_(bytes[1] == 1) {}

  [[nodiscard]] bool ok() const { return ok_; }
  /// Nothing but padding is left.
  [[nodiscard]] bool at_end() const { return ok_ && at_ <= body_.size() && body_.size() - at_ < 4; }

  void message(const MessageLayout& layout) {
    for (const MessageLayout::Field& field : layout.fields) {
      const std::size_t count = field.is_sequence ? number() : field.count;
      if (!ok_) return;
      if (field.size > 0) {
        skip(count, field.size);
      } else {
        // Every message and string takes a byte at least, so this ends with the bytes.
        for (std::size_t i = 0; i < count && ok_; ++i) {
          field.part != nullptr ? message(*field.part) : skip(number(), 1);
        }
      }
    }
  }

 private:
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

}  // namespace

LayoutFit fit(const MessageLayout& layout, std::span<const std::uint8_t> bytes) {
  Walker walk(bytes);
  walk.message(layout);
  if (!walk.ok()) return LayoutFit::kTooShort;
  return walk.at_end() ? LayoutFit::kExact : LayoutFit::kMoreBehind;
}

}  // namespace strata::convert
