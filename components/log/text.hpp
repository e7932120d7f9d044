// SPDX-License-Identifier: Apache-2.0
/// Text files line by line, plain or gzipped, and numbers without the locale.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/time.hpp"

namespace strata::log {

/// Reads a text file; gzip is told by content. Throws InputError when it cannot be opened.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path);
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// The next line without its end (\n or \r\n); false at the end.
  bool next(std::string& line);
  /// From 1, of the line that `next` gave last.
  [[nodiscard]] std::size_t line_number() const { return line_number_; }
  /// "file:line".
  [[nodiscard]] std::string place() const;
  /// Whether the last line lacked its end of line, as when a file was cut.
  [[nodiscard]] bool ended_without_newline() const { return ended_without_newline_; }
  /// Why reading stopped early (a damaged gzip stream); empty when it did not.
  [[nodiscard]] const std::string& damage() const { return damage_; }
  /// The same for people, with the place.
  [[nodiscard]] InputError damage_error() const;

 private:
  bool fill();
  std::filesystem::path path_;
  void* file_ = nullptr;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t line_number_ = 0;
  bool ended_without_newline_ = false;
  std::string damage_;
};

/// Cuts at spaces and tabs; `words` is reused.
void split(std::string_view line, std::vector<std::string_view>& words);
/// The whole text as a number; "nan" and "inf" are numbers.
[[nodiscard]] std::optional<double> parse_double(std::string_view text);
[[nodiscard]] std::optional<float> parse_float(std::string_view text);
[[nodiscard]] std::optional<long long> parse_integer(std::string_view text);
/// Seconds with a fraction as exact nanoseconds (a double cannot hold today's epoch to 1 ns).
[[nodiscard]] std::optional<Stamp> parse_stamp(std::string_view text);

/// The shortest text that reads back to the same bits.
[[nodiscard]] std::string format_number(double value);
[[nodiscard]] std::string format_number(float value);
/// Seconds with at least 6 and, where needed, 9 decimals.
[[nodiscard]] std::string format_stamp(Stamp stamp);

}  // namespace strata::log
