// SPDX-License-Identifier: Apache-2.0
/// Records of bags, field by field.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "components/log/compression.hpp"

namespace strata::log {

/// Little-endian fields one after the other; `ok` turns false when they run out.
class ByteCursor {
 public:
  explicit ByteCursor(View bytes) : bytes_(bytes) {}
  [[nodiscard]] bool ok() const { return ok_; }
  template <typename T>
  T number() {
    T value = 0;
    const View raw = take(sizeof(T));
    for (std::size_t i = 0; i < raw.size(); ++i) {
      value = static_cast<T>(value | (static_cast<T>(raw[i]) << (8 * i)));
    }
    return value;
  }
  View take(std::uint64_t size) {
    if (!ok_ || size > bytes_.size() - at_) {
      ok_ = false;
      return {};
    }
    const View part = bytes_.subspan(at_, static_cast<std::size_t>(size));
    at_ += static_cast<std::size_t>(size);
    return part;
  }
  std::string text() {
    const View raw = take(number<std::uint32_t>());
    return {raw.begin(), raw.end()};
  }
  std::map<std::string, std::string> text_map() {
    ByteCursor inner(take(number<std::uint32_t>()));
    std::map<std::string, std::string> values;
    while (inner.left() > 0 && inner.ok()) {
      std::string key = inner.text();
      values[std::move(key)] = inner.text();
    }
    return values;
  }
  View rest() { return take(bytes_.size() - at_); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  View bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace strata::log
