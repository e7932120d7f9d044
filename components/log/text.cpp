// SPDX-License-Identifier: Apache-2.0
#include "components/log/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <system_error>

#include <zlib.h>

#include "components/log/spooled_input.hpp"
#include "core/base/error.hpp"

namespace strata::log {
namespace {

gzFile handle(void* file) { return static_cast<gzFile>(file); }

template <typename T>
std::optional<T> parse(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <typename T>
std::string shortest(T value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  char text[64];
  const auto result = std::to_chars(text, text + sizeof text, value);
  return {text, result.ptr};
}

}  // namespace

LineReader::LineReader(const std::filesystem::path& path) : path_(path), buffer_(1 << 16) {
  std::error_code error;
  require_reachable(path);
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path.string(), "is a folder, not a file", "name a file in it");
  }
  file_ = gzopen(readable_path(path).c_str(), "rb");
  if (file_ == nullptr) {
    throw InputError(path.string(), "cannot be opened", "check its permissions");
  }
}

LineReader::~LineReader() { gzclose(handle(file_)); }

std::string LineReader::place() const {
  return path_.string() + ":" + std::to_string(line_number_);
}

InputError LineReader::damage_error() const {
  return {place(), "the compressed file is cut or damaged behind this line; the rest is missing",
          "copy it again (" + damage_ + ")"};
}

bool LineReader::fill() {
  begin_ = 0;
  end_ = 0;
  if (!damage_.empty()) return false;
  const int got = gzread(handle(file_), buffer_.data(), static_cast<unsigned>(buffer_.size()));
  int code = Z_OK;
  const char* text = gzerror(handle(file_), &code);
  if (got < 0 || (code != Z_OK && code != Z_STREAM_END)) damage_ = text;
  if (got <= 0) return false;
  end_ = static_cast<std::size_t>(got);
  return true;
}

bool LineReader::next(std::string& line) {
  line.clear();
  bool any = false;
  while (begin_ < end_ || fill()) {
    any = true;
    const char* from = buffer_.data() + begin_;
    const void* found = std::memchr(from, '\n', end_ - begin_);
    if (found == nullptr) {
      line.append(from, end_ - begin_);
      begin_ = end_;
      continue;
    }
    const auto length = static_cast<std::size_t>(static_cast<const char*>(found) - from);
    line.append(from, length);
    begin_ += length + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    ++line_number_;
    return true;
  }
  if (!any) return false;
  ended_without_newline_ = true;
  ++line_number_;
  return true;
}

void split(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && (line[at] == ' ' || line[at] == '\t')) ++at;
    const std::size_t begin = at;
    while (at < line.size() && line[at] != ' ' && line[at] != '\t') ++at;
    if (at > begin) words.push_back(line.substr(begin, at - begin));
  }
}

std::optional<double> parse_double(std::string_view text) { return parse<double>(text); }
std::optional<float> parse_float(std::string_view text) { return parse<float>(text); }
std::optional<long long> parse_integer(std::string_view text) { return parse<long long>(text); }

std::optional<Stamp> parse_stamp(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const std::size_t dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  const std::string_view fraction =
      dot == std::string_view::npos ? std::string_view{} : text.substr(dot + 1);
  const auto digits = [](std::string_view part) {
    return std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
  };
  if (whole.empty() || !digits(whole) || !digits(fraction)) {
    // An exponent: less exact, but some tools write it.
    const auto seconds = parse_double(text);
    if (!seconds || !(std::abs(*seconds) < 9e9)) return std::nullopt;
    return Stamp::from_seconds(negative ? -*seconds : *seconds);
  }
  if (whole.size() > 10) return std::nullopt;
  std::int64_t ns = *parse_integer(whole);
  if (ns >= 9'000'000'000) return std::nullopt;
  for (std::size_t i = 0; i < 9; ++i) {
    ns = ns * 10 + (i < fraction.size() ? fraction[i] - '0' : 0);
  }
  if (fraction.size() > 9 && fraction[9] >= '5') ++ns;
  return Stamp{negative ? -ns : ns};
}

std::string format_number(double value) { return shortest(value); }
std::string format_number(float value) { return shortest(value); }

std::string format_stamp(Stamp stamp) {
  const bool negative = stamp.ns < 0;
  const auto ns = static_cast<unsigned long long>(negative ? -stamp.ns : stamp.ns);
  char text[64];
  const unsigned long long rest = ns % 1'000'000'000ULL;
  if (rest % 1000 == 0) {
    std::snprintf(text, sizeof text, "%s%llu.%06llu", negative ? "-" : "", ns / 1'000'000'000ULL,
                  rest / 1000);
  } else {
    std::snprintf(text, sizeof text, "%s%llu.%09llu", negative ? "-" : "", ns / 1'000'000'000ULL,
                  rest);
  }
  return text;
}

}  // namespace strata::log
