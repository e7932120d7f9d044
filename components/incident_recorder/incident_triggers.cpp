// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/incident_triggers.hpp"

#include <algorithm>
#include <string_view>

#include "components/log/text.hpp"
#include "components/runtime/diagnostics.hpp"
#include "core/localization/recovery.hpp"

namespace strata::incident_recorder {
namespace {

using localization::HealthState;

constexpr const char* kLost = enum_name(HealthState::kLost);
constexpr const char* kOutdated = enum_name(HealthState::kMapOutdated);

std::string_view without_slash(std::string_view name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

std::string value_of(const diagnostic_msgs::msg::DiagnosticStatus& status, const char* key) {
  return std::string(runtime::value_of(status, key));
}

}  // namespace

bool IncidentTriggers::wants(const std::string& name) const {
  const std::string_view node = without_slash(std::string_view(name).substr(0, name.find(':')));
  const auto is_it = [&](std::string_view source) {
    source = without_slash(source);
    return node.starts_with(source) &&
           (node.size() == source.size() || source.ends_with('/') || node[source.size()] == '/');
  };
  if (!config_.sources.empty()) {
    return std::any_of(config_.sources.begin(), config_.sources.end(), is_it);
  }
  const bool has_namespace = node.find('/') != std::string_view::npos;  // drivers' often have none
  return own_namespace_.empty() || !has_namespace || is_it(own_namespace_);
}

bool IncidentTriggers::falls(Source& source, const std::string& score) const {
  const auto value = log::parse_double(score);
  if (!value) return false;
  if (*value >= 0.5 * (1.0 + config_.score_below)) source.is_armed = true;
  if (*value >= config_.score_below || !source.is_armed) return false;
  source.is_armed = false;
  return true;
}

std::optional<IncidentReason> IncidentTriggers::take(
    const diagnostic_msgs::msg::DiagnosticStatus& status) {
  const std::string& name = status.name();
  if (!wants(name)) return std::nullopt;
  const bool is_known = sources_.contains(name);
  if (!is_known && sources_.size() >= kMaxSources) return std::nullopt;
  Source& source = sources_[name];
  const Source before = source;
  source.level = status.level();
  source.verdict = value_of(status, "verdict");
  source.is_recovering = value_of(status, "recovering") == "true";
  const std::string score = value_of(status, "score");
  const bool has_fallen = falls(source, score);
  if (!is_known) return std::nullopt;

  const auto becomes = [&](const char* verdict) {
    return source.verdict == verdict && before.verdict != verdict;
  };
  if (config_.on_lost && becomes(kLost)) {
    return IncidentReason{"lost", name, name + " says that the robot is lost"};
  }
  if (has_fallen) return IncidentReason{"score", name, name + ": score fell to " + score};
  // Stale counts as an error: who watches others says so of the silent.
  const auto error = static_cast<std::uint8_t>(runtime::HealthLevel::kError);
  const bool is_told_as_lost = source.verdict == kLost;
  if (config_.on_error && source.level >= error && before.level < error && !is_told_as_lost) {
    return IncidentReason{"error", name, name + ": " + status.message()};
  }
  if (config_.on_recovery && source.is_recovering && !before.is_recovering) {
    return IncidentReason{"recovery", name, name + " doubts its pose and looks for the robot"};
  }
  if (config_.on_outdated && becomes(kOutdated)) {
    return IncidentReason{"outdated", name, name + " says that the map is outdated here"};
  }
  return std::nullopt;
}

}  // namespace strata::incident_recorder
