// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/incident_recorder.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "strata_idl/rcl_interfaces.h"

#include "components/bus/recorded_topic.hpp"
#include "components/convert/cdr.hpp"
#include "components/log/stored_bytes.hpp"
#include "components/log/writable_place.hpp"
#include "components/runtime/diagnostics.hpp"
#include "core/base/error.hpp"

namespace strata::incident_recorder {
namespace {

constexpr double kBytesPerMb = 1e6;

IncidentRecorder::Clock::duration seconds(double value) {
  return std::chrono::duration_cast<IncidentRecorder::Clock::duration>(
      std::chrono::duration<double>(value));
}

KeptTopic kept_topic(const std::string& topic, const bus::PublishedTopic& published) {
  return {topic, published.type, bus::offered_qos_text(published), published.transient_local,
          bus::offered_type_hash(published)};
}

/// "robot1/" of "/robot1/incidents"; empty where there is none.
std::string namespace_of(const std::string& full_name) {
  return full_name.substr(1, full_name.rfind('/'));
}

/// The topic of a localizer's restore points, below its name
/// (components/localizer/restore_point.hpp).
constexpr const char* kRestorePoint = "/_restore_point";

/// The folder that a restore point names; empty when it names none.
std::string maps_of(const KeptMessage& restore_point) {
  try {
    const auto told = convert::from_cdr<rcl_interfaces::msg::ParameterEvent>(
        restore_point.cdr, restore_point.topic->name);
    for (const auto& value : told.new_parameters()) {
      if (value.name() == "maps") return value.value().string_value();
    }
  } catch (const Error&) {  // another's, by the same name
  }
  return "";
}

}  // namespace

void IncidentRecorder::on_configure() {
  config_ = read_parameters<IncidentRecorderConfig>();
  watched_.clear();
  ring_.emplace(std::chrono::duration<double>(config_.before_s),
                static_cast<std::size_t>(config_.memory_mb * kBytesPerMb));
  diagnostics_ = resolve(runtime::kDiagnosticsTopic);
  // What has a name of its own for it is one robot's.
  const bool is_shared = diagnostics_ == runtime::kDiagnosticsTopic;
  triggers_.emplace(config_.when, is_shared ? namespace_of(full_name()) : "");
  incidents_ = 0;
  rests_until_ = {};
  if (lockstep()) return;
  if (context().dry_run) {
    log::require_folder_place(config_.out);
  } else {
    std::error_code error;
    std::filesystem::create_directories(config_.out, error);
    if (error) {
      throw OutputError(config_.out, "cannot be made: " + error.message(),
                        "choose another folder for incidents");
    }
  }
  offer<bus::srv::Trigger>("~/keep_incident", [this](const auto&) {
    const bool is_active = state() == runtime::LifecycleState::kActive;
    take_waiting();  // it belongs to what came before
    if (is_active) begin({"asked", full_name(), "asked for by ~/keep_incident"});
    std_srvs::srv::Trigger_Response response;
    response.success(is_active);
    response.message(!is_active ? "is not active"
                     : next_    ? "is kept when the one before is on the disk"
                                : "is kept in " + incident_->folder().string());
    return response;
  });
  for (std::string& topic : config_.topics) topic = resolve(topic);
  watch(diagnostics_, {bus::MessageType<diagnostic_msgs::msg::DiagnosticArray>::name, true, false});
  // That this process cannot read what it writes itself is its composition's fault.
  for (const auto& [topic, published] : topics_to_keep()) {
    if (published.is_own) watch(topic, published);
  }
  watch_topics();
}

std::map<std::string, bus::PublishedTopic> IncidentRecorder::topics_to_keep() const {
  return bus::topics_to_record(*context().participant, full_name(), config_.topics,
                               bus::HiddenTopics::kTaken);
}

void IncidentRecorder::watch_topics() {
  const auto topics = topics_to_keep();
  unreadable_.keep_only(topics);
  for (const auto& [topic, published] : topics) {
    (void)unreadable_.read(topic, published, [&] { watch(topic, published); });
  }
}

void IncidentRecorder::watch(const std::string& topic, const bus::PublishedTopic& published) {
  if (!watched_.contains(topic)) begin_watching(topic, published);
  bus::SecondReader& second = watched_.at(topic);
  if (!second.is_needed(published)) return;
  auto kept = kept_topic(topic, published);
  kept.is_latched = false;
  const auto take_others = [this, topic, kept = std::make_shared<const KeptTopic>(kept)](
                               const bus::RawMessage& message) {
    if (watched_.at(topic).takes(message.identity.writer)) take(kept, message);
  };
  subscribe_raw(topic, published.type, second.qos(), take_others, {.at_ticks = true});
  second.begin();
}

void IncidentRecorder::begin_watching(const std::string& topic,
                                      const bus::PublishedTopic& published) {
  const bus::QosProfile qos = bus::qos_to_record(published);
  const auto kept = std::make_shared<const KeptTopic>(kept_topic(topic, published));
  subscribe_raw(topic, published.type, qos,
                [this, kept](const bus::RawMessage& message) { take(kept, message); },
                {.at_ticks = true, .latched_depth = 1});
  watched_.try_emplace(topic, context().participant, topic, qos);
}

void IncidentRecorder::take(const std::shared_ptr<const KeptTopic>& topic,
                            const bus::RawMessage& message) {
  const Stamp stamp =
      bus::stamp_to_record(Stamp{message.source_stamp_ns}, topic->is_latched, bus::wall_now());
  const auto kept = std::make_shared<const KeptMessage>(
      KeptMessage{topic, message.identity.writer, stamp, Clock::now(), message.cdr});
  ring_->add(kept);
  if (incident_) incident_->add(kept);
  if (topic->name.ends_with(kRestorePoint)) restore_points_[topic->name] = kept;
  if (topic->name == diagnostics_) judge(message);
}

void IncidentRecorder::judge(const bus::RawMessage& message) {
  const auto told =
      convert::from_cdr<diagnostic_msgs::msg::DiagnosticArray>(message.cdr, diagnostics_);
  const std::string own = full_name().substr(1) + ": ";
  for (const auto& status : told.status()) {
    if (status.name().starts_with(own)) continue;  // its own trouble is no incident of the robot
    const auto reason = triggers_->take(status);
    if (reason && (incident_ || Clock::now() >= rests_until_)) begin(*reason);
  }
}

std::vector<std::string> IncidentRecorder::files_to_keep() const {
  std::vector<std::string> files = config_.keep_files;
  if (!config_.keep_maps) return files;
  for (const auto& [topic, point] : restore_points_) {
    const std::string maps = maps_of(*point);
    std::error_code error;
    const bool is_here = std::filesystem::is_directory(maps, error);  // the robot's, not another's
    const bool is_new = std::find(files.begin(), files.end(), maps) == files.end();
    if (is_here && is_new) files.push_back(maps);
  }
  return files;
}

void IncidentRecorder::begin(const IncidentReason& reason) {
  const Clock::time_point now = Clock::now();
  if (incident_ && now < ends_at_) {
    incident_->add(reason);
    ends_at_ = std::min(now + seconds(config_.after_s), ends_latest_);
    rests_until_ = ends_at_ + seconds(config_.rest_s);
    return;
  }
  if (incident_) {  // the one before is still on its way to the disk
    if (!next_) next_ = reason;
    return;
  }
  ring_->forget(now);
  IncidentRecord record;
  record.at_ns = bus::wall_now().ns;
  record.folder = free_name(config_.out, record.at_ns, reason.kind);
  record.reasons = {reason};
  record.before_s = config_.before_s;
  record.after_s = config_.after_s;
  const IncidentPlan plan{config_.out, files_to_keep(),
                          static_cast<std::uint64_t>(config_.disk_mb * kBytesPerMb),
                          static_cast<std::size_t>(config_.memory_mb * kBytesPerMb)};
  say(runtime::LogLevel::kWarn, "incident: " + reason.text + "; kept in " + record.folder.string());
  incident_ = std::make_unique<Incident>(plan, std::move(record), ring_->messages());
  ends_at_ = now + seconds(config_.after_s);
  ends_latest_ = now + kLongest;
  rests_until_ = ends_at_ + seconds(config_.rest_s);
  ++incidents_;
}

void IncidentRecorder::settle() {
  if (!incident_) return;
  for (const std::string& problem : incident_->take_problems()) {
    tell(OutputError(config_.out, problem, "keep room on the disk"));
  }
  if (!incident_->is_done()) return;
  incident_.reset();
  if (const auto reason = std::exchange(next_, std::nullopt)) begin(*reason);
}

void IncidentRecorder::on_tick() {
  guarded([&] { watch_topics(); });  // an incident ends whatever comes of it
  const Clock::time_point now = Clock::now();
  ring_->forget(now);
  if (incident_ && now >= ends_at_) incident_->end();
  settle();
}

void IncidentRecorder::on_deactivate() {
  while (incident_) {  // the one that was to come after it, too
    incident_->finish();
    settle();
  }
}

void IncidentRecorder::on_cleanup() {
  incident_.reset();
  next_.reset();
  watched_.clear();
  unreadable_.clear();
  restore_points_.clear();
  ring_.reset();
  triggers_.reset();
}

void IncidentRecorder::on_diagnose(runtime::Health& health) const {
  if (!ring_) return;
  unreadable_.tell(health);
  health.add("incidents", incidents_);
  health.add("is writing one", std::string(incident_ ? "true" : "false"));
  health.add("kept in memory, MB", static_cast<double>(ring_->bytes()) / kBytesPerMb);
  health.add("gone before their time", ring_->gone_early());
  health.add_later("store_bytes", [this] { return log::stored_bytes(config_.out); });
}

}  // namespace strata::incident_recorder
