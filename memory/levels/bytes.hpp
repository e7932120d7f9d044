// SPDX-License-Identifier: Apache-2.0
/// Values as bytes and back, for states that must survive bit for bit. Little-endian.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/damage.hpp"

namespace strata::memory {

static_assert(std::endian::native == std::endian::little);

/// Appends numbers to a growing vector of bytes.
class ByteWriter {
 public:
  template <typename T>
  void write(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    write_span(std::span<const T>(&value, 1));
  }
  template <typename T>
  void write_span(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (values.empty()) return;
    const std::size_t before = bytes_.size();
    bytes_.resize(before + values.size_bytes());
    std::memcpy(bytes_.data() + before, values.data(), values.size_bytes());
  }
  void write(const std::string& text) {
    write(static_cast<std::uint32_t>(text.size()));
    write_span(std::span<const char>(text));
  }
  [[nodiscard]] std::vector<std::byte> take() && { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads them in the same order. Throws DamageError{place} when the bytes end early.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> bytes, std::string place)
      : bytes_(bytes), place_(std::move(place)) {}

  template <typename T>
  [[nodiscard]] T read() {
    T value{};
    read_span(std::span<T>(&value, 1));
    return value;
  }
  template <typename T>
  void read_span(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (values.empty()) return;
    std::memcpy(values.data(), advance(values.size_bytes()), values.size_bytes());
  }
  [[nodiscard]] std::string read_text() {
    const auto size = read<std::uint32_t>();
    const auto* data = advance(size);
    std::string text(size, '\0');
    std::memcpy(text.data(), data, size);
    return text;
  }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }
  /// Throws unless everything was read.
  void finish() const {
    if (!bytes_.empty()) fail("has bytes to spare");
  }
  /// The bytes are damaged. Throws DamageError.
  [[noreturn]] void fail(const std::string& what) const {
    throw DamageError(place_, what, "take it from a backup, or learn it again");
  }

 private:
  const std::byte* advance(std::size_t size) {
    if (size > bytes_.size()) fail("ends too early");
    const std::byte* at = bytes_.data();
    bytes_ = bytes_.subspan(size);
    return at;
  }
  std::span<const std::byte> bytes_;
  std::string place_;
};

}  // namespace strata::memory
