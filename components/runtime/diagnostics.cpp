// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/diagnostics.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "components/convert/geometry_messages.hpp"

namespace strata::runtime {
namespace {

constexpr auto kPeriod = std::chrono::seconds(1);

}  // namespace

std::string_view value_of(const diagnostic_msgs::msg::DiagnosticStatus& status,
                          std::string_view key) {
  for (const auto& entry : status.values()) {
    if (entry.key() == key) return entry.value();
  }
  return {};
}

void Health::add(const std::string& key, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  add(key, std::string(text));
}

void Health::complete() {
  for (const auto& [key, value] : std::exchange(later_, {})) add(key, value());
}

void Health::raise(HealthLevel level, const std::string& message) {
  level_ = std::max(level_, level);
  complaints_.push_back(message);
  message_ += (message_.empty() ? "" : "; ") + message;
}

Diagnostics::Diagnostics(std::shared_ptr<bus::Participant> participant, std::string name,
                         const std::string& topic)
    : name_(std::move(name)),
      writer_(std::make_unique<bus::RawWriter>(
          std::move(participant), topic,
          bus::MessageType<diagnostic_msgs::msg::DiagnosticArray>::name,
          bus::qos_profile("default"))) {}

bool Diagnostics::is_due() const {
  return !last_level_ || std::chrono::steady_clock::now() - last_time_ >= kPeriod;
}

bool Diagnostics::wants(const Health& health) const {
  return is_due() || health.level() > *last_level_;
}

bool Diagnostics::publish(const Health& health, Stamp stamp) {
  if (!wants(health)) return false;
  last_level_ = health.level();
  last_time_ = std::chrono::steady_clock::now();
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level(static_cast<std::uint8_t>(health.level()));
  // ROS 2 monitors make a tree of the part before the colon.
  status.name(name_.substr(1) + ": health");
  status.message(health.message());
  status.hardware_id("strata");
  for (const auto& [key, value] : health.values()) {
    diagnostic_msgs::msg::KeyValue entry;
    entry.key(key);
    entry.value(value);
    status.values().push_back(std::move(entry));
  }
  diagnostic_msgs::msg::DiagnosticArray message;
  message.header(convert::make_header(stamp, ""));
  message.status().push_back(std::move(status));
  writer_->publish(convert::to_cdr(message));
  return true;
}

}  // namespace strata::runtime
