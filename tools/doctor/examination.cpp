// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/examination.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "components/bus/names.hpp"
#include "tools/doctor/network_findings.hpp"
#include "tools/doctor/topic_use.hpp"

namespace strata::doctor {
namespace {

using bus::DiscoveredEndpoint;
using bus::Guid;

constexpr double kClockTolerance_s = 0.1;

std::string full_name_of(const bus::NodeInfo& node) {
  return (node.node_namespace == "/" ? "" : node.node_namespace) + "/" + node.name;
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f s", seconds);
  return text;
}

std::string words_of(const DiscoveredEndpoint& endpoint) {
  return std::string(endpoint.reliable ? "reliable" : "best effort") + ", " +
         (endpoint.transient_local ? "transient local" : "volatile");
}

/// Turns what was observed into the report, topic by topic.
class Examiner {
 public:
  explicit Examiner(const Observed& observed) : observed_(observed) {
    for (const auto& [participant, nodes] : observed.nodes) {
      if (!nodes.empty()) node_of_[participant] = full_name_of(nodes.front());
      for (const bus::NodeInfo& node : nodes) {
        for (const Guid& guid : node.readers) node_of_[guid] = full_name_of(node);
        for (const Guid& guid : node.writers) node_of_[guid] = full_name_of(node);
      }
    }
  }

  Report run() {
    add_participants();
    std::map<std::string, std::vector<DiscoveredEndpoint>> topics;
    for (const DiscoveredEndpoint& endpoint : observed_.view.endpoints) {
      if (is_own(endpoint.guid)) continue;
      topics[endpoint.wire_topic].push_back(endpoint);
    }
    for (const auto& [wire_name, endpoints] : topics) add_topic(wire_name, endpoints);
    find_unpublished();
    for (const auto& [topic, why] : observed_.refused) {
      find(false, topic, "was not listened to: " + why,
           "give this doctor an enclave that may read it, if it matters");
    }
    compare_clocks();
    const auto name_of = [this](const Guid& guid) { return owner_of(guid); };
    for (const auto& find_more : {find_losses, find_users_apart}) {
      for (Finding& finding : find_more(observed_, name_of)) {
        report_.findings.push_back(std::move(finding));
      }
    }
    if (report_.participants.empty()) {
      find(true, "domain", "nobody else is here",
           "compare ROS_DOMAIN_ID and transport with the robot's, and look for a firewall on UDP "
           "7400 and above");
    }
    std::stable_partition(report_.findings.begin(), report_.findings.end(),
                          [](const Finding& finding) { return finding.is_error; });
    return std::move(report_);
  }

 private:
  [[nodiscard]] bool is_own(const Guid& guid) const {
    return bus::same_participant(guid, observed_.self);
  }
  [[nodiscard]] std::string owner_of(const Guid& guid) const {
    const auto found = node_of_.find(guid);
    return found != node_of_.end() ? found->second : bus::guid_text(guid);
  }
  void find(bool is_error, const std::string& place, const std::string& what,
            const std::string& advice) {
    report_.findings.push_back({is_error, place, what, advice});
  }

  void add_participants() {
    for (const bus::DiscoveredParticipant& participant : observed_.view.participants) {
      if (is_own(participant.guid)) continue;
      ParticipantReport entry;
      entry.guid = bus::guid_text(participant.guid);
      entry.vendor = bus::vendor_name(bus::vendor_of(participant.guid));
      entry.enclave = participant.enclave;
      if (const auto found = observed_.nodes.find(participant.guid);
          found != observed_.nodes.end()) {
        for (const bus::NodeInfo& node : found->second) {
          entry.nodes.push_back(full_name_of(node));
          if (!names_.insert({entry.nodes.back(), entry.guid}).second) {
            find(false, entry.nodes.back(), "two nodes have this name",
                 "give each node of the domain its own name or namespace");
          }
        }
      }
      report_.participants.push_back(std::move(entry));
    }
  }

  void add_topic(const std::string& wire_name, const std::vector<DiscoveredEndpoint>& endpoints) {
    const std::string ros_name = bus::topic_from_wire(wire_name);
    TopicReport topic;
    topic.name = ros_name.empty() ? wire_name : ros_name;
    const std::string ros_type = bus::type_from_wire(endpoints.front().wire_type);
    topic.type = ros_type.empty() ? endpoints.front().wire_type : ros_type;
    for (const DiscoveredEndpoint& endpoint : endpoints) {
      (endpoint.writes ? topic.writers : topic.readers).push_back(owner_of(endpoint.guid));
      const auto heard = observed_.heard.find(endpoint.guid);
      if (heard == observed_.heard.end() || observed_.listened_s <= 0.0) continue;
      topic.rate_hz += static_cast<double>(heard->second.messages) / observed_.listened_s;
      topic.bytes_per_s += static_cast<double>(heard->second.bytes) / observed_.listened_s;
    }
    for (const DiscoveredEndpoint& writer : endpoints) {
      for (const DiscoveredEndpoint& reader : endpoints) {
        if (writer.writes && !reader.writes) compare(topic.name, writer, reader);
      }
    }
    topic.is_plumbing = is_plumbing(wire_name);
    report_.topics.push_back(std::move(topic));
  }

  /// Odometry comes as a topic of its own or as transforms: one of the two is enough.
  [[nodiscard]] static bool may_hold_odometry(const TopicReport& topic) {
    return topic.type == "nav_msgs/msg/Odometry" || topic.name.ends_with("/tf");
  }
  [[nodiscard]] bool has_other_odometry(const TopicReport& topic, const std::string& reader) const {
    return std::any_of(report_.topics.begin(), report_.topics.end(), [&](const TopicReport& other) {
      return other.name != topic.name && may_hold_odometry(other) && !other.writers.empty() &&
             std::find(other.readers.begin(), other.readers.end(), reader) != other.readers.end();
    });
  }
  void find_unpublished() {
    for (const TopicReport& topic : report_.topics) {
      const bool is_of_ros = topic.name.starts_with('/');
      if (!is_of_ros || topic.is_plumbing || !topic.writers.empty()) continue;
      if (is_occasional(topic.name)) continue;
      const auto lacks = [&](const std::string& reader) {
        return !may_hold_odometry(topic) || !has_other_odometry(topic, reader);
      };
      const auto who = std::find_if(topic.readers.begin(), topic.readers.end(), lacks);
      if (who == topic.readers.end()) continue;
      find(false, topic.name, "is read by " + *who + " and published by nobody",
           "start what publishes it, or remap the reader");
    }
  }

  void compare(const std::string& topic, const DiscoveredEndpoint& writer,
               const DiscoveredEndpoint& reader) {
    const std::string pair = owner_of(writer.guid) + " publishes, " + owner_of(reader.guid);
    if (writer.wire_type != reader.wire_type) {
      find(true, topic,
           pair + " reads another type (" + writer.wire_type + ", " + reader.wire_type + ")",
           "remap one of the two topics");
      return;
    }
    if (!writer.type_hash.empty() && !reader.type_hash.empty() &&
        writer.type_hash != reader.type_hash) {
      find(false, topic,
           pair + " reads another version of the type (" + writer.type_hash + ", " +
               reader.type_hash + ")",
           "build both with the same message package");
    }
    const bool reliability = reader.reliable && !writer.reliable;
    const bool durability = reader.transient_local && !writer.transient_local;
    const bool deadline =
        reader.deadline_s > 0.0 &&
        (writer.deadline_s <= 0.0 || writer.deadline_s > reader.deadline_s);  // 0: none offered
    if (!reliability && !durability && !deadline) return;
    std::string advice;
    const auto advise = [&](const char* text) {
      advice += (advice.empty() ? "" : "; ") + std::string(text);
    };
    if (reliability) advise("let the writer be reliable or the reader best effort");
    if (durability) advise("let the writer be transient local or the reader volatile");
    if (deadline) advise("let the writer offer a deadline as short as the reader's");
    find(true, topic,
         pair + " gets nothing: offered " + words_of(writer) + ", wanted " + words_of(reader),
         advice);
  }

  void compare_clocks() {
    std::map<Guid, double> least;  // by participant
    for (const auto& [writer, heard] : observed_.heard) {
      if (heard.messages == 0) continue;
      for (const bus::DiscoveredParticipant& participant : observed_.view.participants) {
        if (!bus::same_participant(writer, participant.guid)) continue;
        const auto [entry, is_first] = least.insert({participant.guid, heard.min_delay_s});
        if (!is_first) entry->second = std::min(entry->second, heard.min_delay_s);
      }
    }
    for (const auto& [guid, delay] : least) {
      if (std::abs(delay) <= kClockTolerance_s) continue;
      find(true, bus::guid_text(guid),
           delay < 0.0
               ? "its clock is ahead of ours by " + seconds_text(-delay)
               : "its clock is behind ours, or its messages late, by " + seconds_text(delay),
           "synchronize the clocks (chrony, PTP): transforms are looked up by time");
    }
  }

  const Observed& observed_;
  std::map<Guid, std::string> node_of_;
  std::map<std::string, std::string> names_;
  Report report_;
};

}  // namespace

std::size_t Report::errors() const {
  return static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [](const Finding& finding) { return finding.is_error; }));
}

Report examine(const Observed& observed) { return Examiner(observed).run(); }

}  // namespace strata::doctor
