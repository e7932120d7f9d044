// SPDX-License-Identifier: Apache-2.0
/// Objects as bytes and back, for what a process goes on with after it was stopped: the same
/// version on the same kind of machine. Not a format for exchange.
///
/// A class with more than plain values, or with gaps between them, lists them once, for both
/// directions:
///
///     template <class Self, class Archive>
///     static void state(Self& self, Archive& archive) { archive(self.a_); archive(self.b_); }
///
/// or has a function state_of(object, archive) beside it. What an index or a number may be is
/// checked there, after it was read (Archive::kReads).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/damage.hpp"

namespace strata {

template <typename T, typename Archive>
void state_of(T& value, Archive& archive) {
  std::remove_const_t<T>::state(value, archive);
}

/// Whether a class lists its values itself. Then they are never copied with the gaps between them,
/// whose bytes are anybody's.
template <typename T, typename Archive>
concept ListsItsState = requires(T& value, Archive& archive) {
  std::remove_const_t<T>::state(value, archive);
};

/// Copied byte by byte.
template <typename T, typename Archive>
inline constexpr bool is_plain_state =
    std::is_trivially_copyable_v<T> && !ListsItsState<T, Archive>;

/// Appends values to bytes.
class StateWriter {
 public:
  static constexpr bool kReads = false;

  template <typename T>
  void operator()(const T& value) {
    if constexpr (is_plain_state<const T, StateWriter>) {
      append(&value, sizeof value);
    } else {
      state_of(value, *this);
    }
  }
  template <typename T>
  void operator()(const std::vector<T>& values) {
    (*this)(static_cast<std::uint64_t>(values.size()));
    if constexpr (is_plain_state<const T, StateWriter>) {
      append(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) (*this)(value);
    }
  }
  void operator()(const std::vector<bool>& values) {
    (*this)(std::vector<std::uint8_t>(values.begin(), values.end()));
  }
  template <typename T>
  void operator()(const std::deque<T>& values) {
    (*this)(static_cast<std::uint64_t>(values.size()));
    for (const T& value : values) (*this)(value);
  }
  template <typename A, typename B>
  void operator()(const std::pair<A, B>& value) {
    (*this)(value.first);
    (*this)(value.second);
  }
  template <typename T>
  void operator()(const std::optional<T>& value) {
    (*this)(value.has_value());
    if (value) (*this)(*value);
  }

  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size()));
    append(text.data(), text.size());
  }
  /// Without their number, which the reader knows from elsewhere.
  template <typename T>
  void values(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(values.data(), values.size_bytes());
  }

  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }
  [[nodiscard]] std::vector<std::byte> take_bytes() {
    const auto bytes = std::as_bytes(std::span(bytes_));
    return {bytes.begin(), bytes.end()};
  }

 private:
  void append(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::size_t before = bytes_.size();
    bytes_.resize(before + size);
    std::memcpy(bytes_.data() + before, data, size);
  }
  std::vector<std::uint8_t> bytes_;
};

/// Reads them in the same order. Throws DamageError where the bytes end too early; no length that
/// they claim takes more memory than there are bytes.
class StateReader {
 public:
  static constexpr bool kReads = true;

  /// place: of the bytes, for errors.
  StateReader(std::span<const std::uint8_t> bytes, std::string place)
      : StateReader(std::as_bytes(bytes), std::move(place)) {}
  StateReader(std::span<const std::byte> bytes, std::string place)
      : bytes_(bytes), place_(std::move(place)) {}

  template <typename T>
  void operator()(T& value) {
    if constexpr (is_plain_state<T, StateReader>) {
      copy(&value, sizeof value);
      check_enum(value);
    } else {
      state_of(value, *this);
    }
  }
  /// A byte that is neither 0 nor 1 is no bool, and must not become one.
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    copy(&byte, sizeof byte);
    if (byte > 1) fail("is damaged");
    value = byte == 1;
  }
  template <typename T>
  void operator()(std::vector<T>& values) {
    if constexpr (is_plain_state<T, StateReader>) {
      values.resize(length(sizeof(T)));
      copy(values.data(), values.size() * sizeof(T));
      for (const T& value : values) check_enum(value);
    } else {
      const std::size_t count = length(1);
      if (values.size() > count) values.resize(count);
      for (std::size_t i = 0; i < count; ++i) {
        if (i == values.size()) values.emplace_back();  // grows with what is read
        (*this)(values[i]);
      }
    }
  }
  void operator()(std::vector<bool>& values) {
    std::vector<std::uint8_t> bytes;
    (*this)(bytes);
    values.assign(bytes.begin(), bytes.end());
  }
  template <typename T>
  void operator()(std::deque<T>& values) {
    values.resize(length(1));
    for (T& value : values) (*this)(value);
  }
  template <typename A, typename B>
  void operator()(std::pair<A, B>& value) {
    (*this)(value.first);
    (*this)(value.second);
  }
  template <typename T>
  void operator()(std::optional<T>& value) {
    bool has_value = false;
    (*this)(has_value);
    value.reset();
    if (has_value) (*this)(value.emplace());
  }
  void operator()(std::string& text) {
    std::uint32_t size = 0;
    (*this)(size);
    if (size > bytes_.size()) fail("claims more than it holds");
    text.resize(size);
    copy(text.data(), size);
  }
  template <typename T>
  void values(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    copy(values.data(), values.size_bytes());
    for (const T& value : values) check_enum(value);
  }
  /// How many items follow, each of at least so many bytes.
  [[nodiscard]] std::size_t length(std::size_t item_bytes) {
    std::uint64_t count = 0;
    (*this)(count);
    if (count > bytes_.size() / item_bytes) fail("claims more than it holds");
    return static_cast<std::size_t>(count);
  }
  /// Throws InputError unless the next number is this.
  void expect_version(std::uint64_t version) {
    std::uint64_t found = 0;
    (*this)(found);
    if (found != version) refuse("is of another version");
  }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }
  /// Throws DamageError unless everything was read.
  void expect_end() const {
    if (!bytes_.empty()) fail("goes on behind its end");
  }
  /// The bytes are damaged. Throws DamageError.
  [[noreturn]] void fail(const std::string& what) const {
    throw DamageError(place_, "the saved state " + what,
                      "remove it to begin anew, or take it from a backup");
  }
  /// They may be whole, but not for us. Throws InputError.
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(place_, "the saved state " + what,
                     "remove it to begin anew, or take it from a backup");
  }

 private:
  /// An enum needs a function last_enumerator(T) beside it.
  template <typename T>
  void check_enum(const T& value) const {
    if constexpr (std::is_enum_v<T>) {
      using Number = std::make_unsigned_t<std::underlying_type_t<T>>;
      if (static_cast<Number>(value) > static_cast<Number>(last_enumerator(value))) {
        fail("is damaged");
      }
    }
  }
  void copy(void* data, std::size_t size) {
    if (size > bytes_.size()) fail("ends too early");
    if (size == 0) return;
    std::memcpy(data, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }
  std::span<const std::byte> bytes_;
  std::string place_;
};

}  // namespace strata
