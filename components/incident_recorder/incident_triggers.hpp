// SPDX-License-Identifier: Apache-2.0
/// Which statuses on /diagnostics begin an incident.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "components/bus/message_types.hpp"
#include "components/incident_recorder/config.hpp"

namespace strata::incident_recorder {

/// Why something is an incident.
struct IncidentReason {
  std::string kind;    ///< "lost", "outdated", "score", "recovery", "error" or "asked"
  std::string source;  ///< the status's name, "localizer: health"
  std::string text;    ///< for people
};

/// Follows every status by its name. What a source says first begins nothing: a robot that starts
/// without its scanner has no minute before. Statuses are kept for kMaxSources sources; others say
/// nothing.
class IncidentTriggers {
 public:
  static constexpr std::size_t kMaxSources = 1000;
  /// own_namespace: "robot1/", of the recorder; empty: none.
  explicit IncidentTriggers(IncidentTriggerConfig config, std::string own_namespace = "")
      : config_(std::move(config)), own_namespace_(std::move(own_namespace)) {}

  /// Whether a status of that name is listened to: those of `sources` or, where that is empty, all
  /// but those of nodes in other namespaces than the recorder's, if it has one.
  [[nodiscard]] bool wants(const std::string& name) const;

  /// What began with this status, the worst of several. A score arms when it is closer to 1 than
  /// to the threshold, so that one that wavers about it begins one incident.
  [[nodiscard]] std::optional<IncidentReason> take(
      const diagnostic_msgs::msg::DiagnosticStatus& status);

 private:
  struct Source {
    std::uint8_t level = 0;
    std::string verdict;
    bool is_recovering = false;
    bool is_armed = false;
  };
  [[nodiscard]] bool falls(Source& source, const std::string& score) const;
  IncidentTriggerConfig config_;
  std::string own_namespace_;
  std::map<std::string, Source> sources_;
};

}  // namespace strata::incident_recorder
