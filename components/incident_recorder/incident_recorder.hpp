// SPDX-License-Identifier: Apache-2.0
/// strata::IncidentRecorder: keeps the last minute of every topic in memory, and writes it down
/// when something goes wrong.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "components/bus/participant.hpp"
#include "components/bus/second_reader.hpp"
#include "components/incident_recorder/config.hpp"
#include "components/incident_recorder/incident.hpp"
#include "components/incident_recorder/incident_triggers.hpp"
#include "components/incident_recorder/message_ring.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/unreadable_topics.hpp"

namespace strata::incident_recorder {

/// Reads as the writers that are there offer, as strata::Recorder does. What begins an incident is
/// read off /diagnostics (IncidentTriggers), or asked for by the service ~/keep_incident
/// (std_srvs/Trigger). One at a time is written; what goes wrong while it lasts prolongs it, to
/// kLongest at most, and is named in its record. In lockstep it rests: a replay of an incident must
/// not make another.
class IncidentRecorder final : public runtime::Component {
 public:
  using Component::Component;
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::minutes kLongest{10};

 private:
  void on_declare() override { declare_parameters<IncidentRecorderConfig>(); }
  void on_configure() override;
  void on_tick() override;
  void on_deactivate() override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  [[nodiscard]] std::map<std::string, bus::PublishedTopic> topics_to_keep() const;
  /// Those that can be read.
  void watch_topics();
  void watch(const std::string& topic, const bus::PublishedTopic& published);
  void begin_watching(const std::string& topic, const bus::PublishedTopic& published);
  void take(const std::shared_ptr<const KeptTopic>& topic, const bus::RawMessage& message);
  void judge(const bus::RawMessage& message);
  /// What is kept a copy of: keep_files, and the folders of maps that localizers use.
  [[nodiscard]] std::vector<std::string> files_to_keep() const;
  /// Begins an incident, prolongs the one that lasts, or leaves the reason for when the one before
  /// is on the disk.
  void begin(const IncidentReason& reason);
  /// Lets go of one that is on the disk.
  void settle();

  IncidentRecorderConfig config_;
  std::string diagnostics_;                           ///< the topic, as it is remapped
  std::map<std::string, bus::SecondReader> watched_;  ///< by topic; of later writers
  runtime::UnreadableTopics unreadable_{[this](const std::string& line) { tell_line(line); }};
  std::optional<MessageRing> ring_;
  std::map<std::string, KeptMessagePtr> restore_points_;  ///< the last of each topic
  std::optional<IncidentTriggers> triggers_;
  std::unique_ptr<Incident> incident_;
  std::optional<IncidentReason> next_;  ///< came while the one before went to the disk
  Clock::time_point ends_at_;
  Clock::time_point ends_latest_;
  Clock::time_point rests_until_;
  std::uint64_t incidents_ = 0;
};

}  // namespace strata::incident_recorder
