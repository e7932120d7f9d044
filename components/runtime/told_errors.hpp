// SPDX-License-Identifier: Apache-2.0
/// Which errors of a component are told in words: the first of a kind at once, what repeats as a
/// number. Who sends a thousand bad messages a second must not fill a log.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace strata::runtime {

class ToldErrors {
 public:
  using Clock = std::chrono::steady_clock;
  /// After its first time an error is told once so often, with how many there were.
  static constexpr auto kPeriod = std::chrono::seconds(30);
  /// As many kinds are known by their words; what is beyond is told together.
  static constexpr std::size_t kMaxKinds = 16;

  /// What to say of this error now, if anything.
  [[nodiscard]] std::optional<std::string> take(const std::string& text, Clock::time_point now);
  /// What is to be said of those that only counted until now.
  [[nodiscard]] std::vector<std::string> due(Clock::time_point now);

 private:
  struct Kind {
    Clock::time_point told;
    std::uint64_t since = 0;  // how many since then
  };
  std::map<std::string, Kind> kinds_;
};

/// One line, without what would command a terminal, of valid UTF-8 and at most 1000 bytes: parts of
/// messages that others sent may be in it.
[[nodiscard]] std::string one_line(std::string_view text);

}  // namespace strata::runtime
