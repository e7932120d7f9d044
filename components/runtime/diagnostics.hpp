// SPDX-License-Identifier: Apache-2.0
/// How a component is, as ROS 2's diagnostics tell it: one status a component on /diagnostics, once
/// a second and at once when it gets worse.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"
#include "core/base/time.hpp"

namespace strata::runtime {

inline constexpr const char* kDiagnosticsTopic = "/diagnostics";

/// The levels of diagnostic_msgs/DiagnosticStatus.
enum class HealthLevel : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };

/// What a component says of itself. The worst level counts; messages are joined.
class Health {
 public:
  void warn(const std::string& message) { raise(HealthLevel::kWarn, message); }
  void fail(const std::string& message) { raise(HealthLevel::kError, message); }
  void add(const std::string& key, const std::string& value) { values_.emplace_back(key, value); }
  void add(const std::string& key, std::uint64_t value) { add(key, std::to_string(value)); }
  void add(const std::string& key, double value);
  /// A figure that costs something: asked for when the status is sent.
  void add_later(const std::string& key, std::function<std::uint64_t()> value) {
    later_.emplace_back(key, std::move(value));
  }
  /// Adds the figures that are still to be asked for.
  void complete();

  [[nodiscard]] HealthLevel level() const { return level_; }
  /// "OK" when nobody complained.
  [[nodiscard]] std::string message() const { return message_.empty() ? "OK" : message_; }
  /// Each thing that message() says, for itself.
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& values() const {
    return values_;
  }

 private:
  void raise(HealthLevel level, const std::string& message);
  HealthLevel level_ = HealthLevel::kOk;
  std::string message_;
  std::vector<std::string> complaints_;
  std::vector<std::pair<std::string, std::string>> values_;
  std::vector<std::pair<std::string, std::function<std::uint64_t()>>> later_;
};

/// What a status that came says under that key; empty: nothing. Lives as long as the status.
[[nodiscard]] std::string_view value_of(const diagnostic_msgs::msg::DiagnosticStatus& status,
                                        std::string_view key);

/// Publishes one component's health. Not thread safe: used on the component's mailbox.
class Diagnostics {
 public:
  /// name: the component's full name, "/robot1/localizer". topic: where it goes, resolved.
  Diagnostics(std::shared_ptr<bus::Participant> participant, std::string name,
              const std::string& topic = kDiagnosticsTopic);

  /// Whether a second has passed since the last status.
  [[nodiscard]] bool is_due() const;
  /// ... or this one is worse.
  [[nodiscard]] bool wants(const Health& health) const;
  /// Sends the status when wants() it; whether it did.
  bool publish(const Health& health, Stamp stamp);

  [[nodiscard]] const bus::RawWriter& writer() const { return *writer_; }

 private:
  std::string name_;
  std::unique_ptr<bus::RawWriter> writer_;
  std::optional<HealthLevel> last_level_;
  std::chrono::steady_clock::time_point last_time_{};
};

}  // namespace strata::runtime
