// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/told_errors.hpp"

#include <algorithm>
#include <utility>

namespace strata::runtime {
namespace {

constexpr const char* kOthers = "errors of further kinds";
constexpr std::size_t kMaxBytes = 1000;

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// The bytes of the character that begins there; 0 when none does.
std::size_t character_bytes(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  if (first < 0x20U || first == 0x7FU) return 0;
  if (first < 0x80U) return 1;
  std::size_t bytes = 0;
  if (first >= 0xC2U && first < 0xE0U) bytes = 2;
  if (first >= 0xE0U && first < 0xF0U) bytes = 3;
  if (first >= 0xF0U && first < 0xF5U) bytes = 4;
  if (bytes == 0 || text.size() < bytes) return 0;
  const auto second = static_cast<unsigned char>(text[1]);
  const bool is_command = first == 0xC2U && second < 0xA0U;  // of terminals, in 8 bits
  const bool is_overlong = (first == 0xE0U && second < 0xA0U) || (first == 0xF0U && second < 0x90U);
  const bool is_outside =
      (first == 0xEDU && second >= 0xA0U) || (first == 0xF4U && second >= 0x90U);
  if (is_command || is_overlong || is_outside) return 0;
  return std::all_of(text.begin() + 1, text.begin() + static_cast<std::ptrdiff_t>(bytes),
                     is_continuation)
             ? bytes
             : 0;
}

}  // namespace

std::optional<std::string> ToldErrors::take(const std::string& text, Clock::time_point now) {
  auto found = kinds_.find(text);
  const bool is_new = found == kinds_.end();
  if (is_new && kinds_.size() >= kMaxKinds) {
    const auto [others, is_first] = kinds_.try_emplace(kOthers, Kind{now, 0});
    ++others->second.since;
    if (!is_first) return std::nullopt;
    return std::string(kOthers) + " come too fast to be told one by one";
  }
  if (is_new) {
    kinds_.emplace(text, Kind{now, 0});
    return text;
  }
  ++found->second.since;
  return std::nullopt;
}

std::vector<std::string> ToldErrors::due(Clock::time_point now) {
  std::vector<std::string> lines;
  for (auto it = kinds_.begin(); it != kinds_.end();) {
    Kind& kind = it->second;
    if (now - kind.told < kPeriod) {
      ++it;
    } else if (kind.since == 0) {
      it = kinds_.erase(it);
    } else {
      lines.push_back(
          it->first + " (" + std::to_string(kind.since) + " more in " +
          std::to_string(
              std::chrono::duration_cast<std::chrono::seconds>(now - kind.told).count()) +
          " s)");
      kind = {now, 0};
      ++it;
    }
  }
  return lines;
}

std::string one_line(std::string_view text) {
  std::string line;
  while (!text.empty() && line.size() < kMaxBytes) {
    const std::size_t bytes = character_bytes(text);
    if (bytes == 0) {
      line += text.front() == '\n' ? ' ' : '?';
    } else {
      line += text.substr(0, bytes);
    }
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  if (!text.empty()) line += " ...";
  return line;
}

}  // namespace strata::runtime
