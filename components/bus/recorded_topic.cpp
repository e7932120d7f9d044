// SPDX-License-Identifier: Apache-2.0
#include "components/bus/recorded_topic.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

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

Stamp wall_now() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
}

Stamp stamp_to_record(Stamp written, bool is_latched, Stamp now) {
  constexpr Duration kLatched{1'000'000'000};  // longer than it takes to come, and to be taken
  constexpr Duration kOthers{60'000'000'000};  // longer than one waits for a slow disk
  const Duration tolerance = is_latched ? kLatched : kOthers;
  const bool is_recent = now - tolerance <= written && written <= now + tolerance;
  return is_recent ? written : now;
}

namespace {

/// As rmw has it: 9223372036.854775807 s are without limit.
std::string duration_text(double duration_s) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t ns =
      duration_s > 0.0 ? std::llround(duration_s * 1e9) : std::numeric_limits<std::int64_t>::max();
  return "\n    sec: " + std::to_string(ns / kSecond) +
         "\n    nsec: " + std::to_string(ns % kSecond);
}

std::string profile_text(const DiscoveredEndpoint& writer) {
  return std::string("- history: 3\n  depth: 0\n  reliability: ") + (writer.reliable ? "1" : "2") +
         "\n  durability: " + (writer.transient_local ? "1" : "2") +
         "\n  deadline:" + duration_text(writer.deadline_s) +
         "\n  lifespan:" + duration_text(writer.lifespan_s) +
         "\n  liveliness: " + std::to_string(static_cast<int>(writer.liveliness)) +
         "\n  liveliness_lease_duration:" + duration_text(writer.lease_s) +
         "\n  avoid_ros_namespace_conventions: false";
}

}  // namespace

std::string offered_qos_text(const PublishedTopic& published) {
  std::string text;
  for (const DiscoveredEndpoint& writer : published.writers) {
    text += (text.empty() ? "" : "\n") + profile_text(writer);
  }
  return text;
}

std::string offered_type_hash(const PublishedTopic& published) {
  std::string hash;
  for (const DiscoveredEndpoint& writer : published.writers) {
    if (writer.type_hash.empty()) continue;
    if (!hash.empty() && hash != writer.type_hash) return {};
    hash = writer.type_hash;
  }
  return hash;
}

}  // namespace strata::bus
