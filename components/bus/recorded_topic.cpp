// SPDX-License-Identifier: Apache-2.0
#include "components/bus/recorded_topic.hpp"

#include <algorithm>

namespace strata::bus {

bool is_hidden(const std::string& full_topic) { return full_topic.find("/_") != std::string::npos; }

std::map<std::string, PublishedTopic> topics_to_record(const Participant& participant,
                                                       const std::string& recorder,
                                                       const std::vector<std::string>& wanted,
                                                       HiddenTopics hidden) {
  auto topics = participant.published_topics();
  std::erase_if(topics, [&](const auto& entry) {
    const std::string& topic = entry.first;
    if (topic.starts_with(recorder + "/") || topic.starts_with("/strata_lockstep/")) return true;
    if (wanted.empty() && hidden == HiddenTopics::kLeftOut && is_hidden(topic)) return true;
    return !wanted.empty() && std::find(wanted.begin(), wanted.end(), topic) == wanted.end();
  });
  return topics;
}

QosProfile qos_to_record(const PublishedTopic& published) {
  constexpr int kDepth = 1000;
  QosProfile qos = qos_profile("sensor_data");
  qos.reliable = published.reliable;
  qos.transient_local = published.transient_local;  // the laser's mounting was sent long ago
  qos.depth = kDepth;
  return qos;
}

std::string offered_qos_text(const PublishedTopic& published) {
  const std::string forever = "\n    sec: 9223372036\n    nsec: 854775807";
  return std::string("- history: 3\n  depth: 0\n  reliability: ") +
         (published.reliable ? "1" : "2") +
         "\n  durability: " + (published.transient_local ? "1" : "2") + "\n  deadline:" + forever +
         "\n  lifespan:" + forever + "\n  liveliness: 1\n  liveliness_lease_duration:" + forever +
         "\n  avoid_ros_namespace_conventions: false";
}

}  // namespace strata::bus
