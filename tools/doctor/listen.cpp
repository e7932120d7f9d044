// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/listen.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "components/bus/endpoint.hpp"
#include "components/bus/names.hpp"
#include "core/base/error.hpp"
#include "tools/doctor/process_user.hpp"

namespace strata::doctor {
namespace {

constexpr double kLookAgain_s = 0.1;

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Counts what comes on every topic it is told of.
class Ear {
 public:
  explicit Ear(std::shared_ptr<bus::Participant> participant)
      : participant_(std::move(participant)) {
    qos_ = bus::qos_profile("sensor_data");
    qos_.depth = 100;
  }

  /// Of a writer of a ROS 2 topic; what is heard of already stays as it is.
  void listen_to(const bus::DiscoveredEndpoint& writer) {
    const std::string topic = bus::topic_from_wire(writer.wire_topic);
    const std::string type = bus::type_from_wire(writer.wire_type);
    if (topic.empty() || type.empty()) return;
    known_since_.emplace(writer.guid, Clock::now());
    subscribe(readers_, topic, type, qos_, [this](const auto& message) { count(message); });
    // Volatile writers of the same topic do not match it.
    if (!writer.reliable || !writer.transient_local) return;
    subscribe(latched_, topic, type, bus::qos_profile("latched"),
              [this](const bus::RawMessage& message) {
                const std::lock_guard lock(mutex_);
                heard_[message.identity.writer].has_latched = true;
              });
  }
  /// Topics that could not be read, and why.
  [[nodiscard]] const std::map<std::string, std::string>& refused() const { return refused_; }
  [[nodiscard]] std::map<bus::Guid, Heard> heard() const {
    const std::lock_guard lock(mutex_);
    std::map<bus::Guid, Heard> heard = heard_;
    for (const auto& [writer, since] : known_since_) {
      heard[writer].known_s = std::chrono::duration<double>(Clock::now() - since).count();
    }
    return heard;
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Readers = std::map<std::string, std::unique_ptr<bus::RawReader>>;

  void subscribe(Readers& readers, const std::string& topic, const std::string& type,
                 const bus::QosProfile& qos, std::function<void(const bus::RawMessage&)> callback) {
    if (readers.count(topic) > 0) return;
    std::unique_ptr<bus::RawReader>& reader = readers[topic];
    try {
      reader =
          std::make_unique<bus::RawReader>(participant_, topic, type, qos, std::move(callback));
    } catch (const ConfigError&) {  // NOLINT(bugprone-empty-catch): a second type is a finding
    } catch (const OutputError& error) {  // as of what a secured domain does not let us read
      refused_.emplace(topic, error.problem());
    }
  }
  void count(const bus::RawMessage& message) {
    const double delay_s = wall_seconds() - static_cast<double>(message.source_stamp_ns) * 1e-9;
    const std::lock_guard lock(mutex_);
    Heard& heard = heard_[message.identity.writer];
    heard.min_delay_s = heard.messages == 0 ? delay_s : std::min(heard.min_delay_s, delay_s);
    if (heard.messages == 0) heard.first_number = message.identity.sequence_number;
    heard.last_number = message.identity.sequence_number;
    ++heard.messages;
    heard.bytes += message.cdr.size();
  }
  std::shared_ptr<bus::Participant> participant_;
  bus::QosProfile qos_;
  mutable std::mutex mutex_;
  std::map<bus::Guid, Heard> heard_;
  std::map<bus::Guid, Clock::time_point> known_since_;
  std::map<std::string, std::string> refused_;
  Readers readers_;  // last: they use the others
  Readers latched_;
};

std::map<bus::Guid, std::string> users_of(const bus::DomainView& view, const bus::Guid& self) {
  std::map<bus::Guid, std::string> users;
  for (const bus::DiscoveredParticipant& participant : view.participants) {
    if (bus::vendor_of(participant.guid) != bus::kVendorFastDds ||
        bus::host_of(participant.guid) != bus::host_of(self)) {
      continue;
    }
    const std::string user =
        participant.guid == self
            ? own_user()
            : user_of_process(bus::process_of(participant.guid), participant.ports);
    if (!user.empty()) users[participant.guid] = user;
  }
  return users;
}

}  // namespace

Observed listen(const std::shared_ptr<bus::Participant>& participant,
                const std::function<bool(double)>& wait) {
  const auto begin = std::chrono::steady_clock::now();
  Ear ear(participant);
  std::map<std::string, std::string> refused;
  std::optional<bus::GraphReader> graph;
  try {
    graph.emplace(participant);
  } catch (const OutputError& error) {
    refused.emplace("ros_discovery_info", error.problem());
  }
  do {
    for (const bus::DiscoveredEndpoint& endpoint : participant->view().endpoints) {
      if (endpoint.writes && !bus::same_participant(endpoint.guid, participant->guid())) {
        ear.listen_to(endpoint);
      }
    }
  } while (wait(kLookAgain_s));
  Observed observed;
  observed.view = participant->view();
  observed.self = participant->guid();
  if (graph) observed.nodes = graph->nodes();
  observed.heard = ear.heard();
  refused.insert(ear.refused().begin(), ear.refused().end());
  observed.refused = std::move(refused);
  observed.users = users_of(observed.view, observed.self);
  observed.listened_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return observed;
}

}  // namespace strata::doctor
