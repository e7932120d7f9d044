// SPDX-License-Identifier: Apache-2.0
/// What is wrong on a DDS domain, from what discovery and a few seconds of listening show. Knows no
/// DDS itself: values in, findings out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "components/bus/domain_view.hpp"
#include "components/bus/node.hpp"

namespace strata::doctor {

/// What was heard of one writer.
struct Heard {
  std::uint64_t messages = 0;  ///< as they were sent, at the first attempt
  std::uint64_t bytes = 0;
  /// Least of (our clock when it came - the writer's clock when it left), s. What a message needs
  /// to get here is in it, so below zero the writer's clock is surely ahead.
  double min_delay_s = 0.0;
  std::int64_t first_number = 0;  ///< the writer's, of the first and the last that came
  std::int64_t last_number = 0;
  bool has_latched = false;  ///< asked for what was published before, some came
  double known_s = 0.0;      ///< for how long the writer has been listened to
};

struct Observed {
  bus::DomainView view;
  bus::Guid self{};  ///< our own participant, which is left out
  std::map<bus::Guid, std::vector<bus::NodeInfo>> nodes;
  std::map<bus::Guid, Heard> heard;            ///< by writer
  std::map<bus::Guid, std::string> users;      ///< who runs it, by participant of this host
  std::map<std::string, std::string> refused;  ///< topics that could not be read, and why
  double listened_s = 0.0;
};

struct ParticipantReport {
  std::string guid;
  std::string vendor;
  std::string enclave;
  std::vector<std::string> nodes;  ///< full names
};

struct TopicReport {
  std::string name;                  ///< "/scan", or the wire name of what is no ROS 2 topic
  std::string type;                  ///< of the first endpoint
  std::vector<std::string> writers;  ///< nodes, or GUIDs of endpoints without one
  std::vector<std::string> readers;
  double rate_hz = 0.0;
  double bytes_per_s = 0.0;
  bool is_plumbing = false;  ///< topic_use.hpp
};

struct Finding {
  bool is_error = false;  ///< things do not work; else worth knowing
  std::string place;      ///< topic, node or participant
  std::string what;
  std::string advice;
};

struct Report {
  std::vector<ParticipantReport> participants;
  std::vector<TopicReport> topics;
  std::vector<Finding> findings;  ///< errors first
  [[nodiscard]] std::size_t errors() const;
};

/// Endpoints of one topic that do not match each other (type, reliability, durability, deadline),
/// clocks that differ by more than 0.1 s, topics that somebody needs and nobody writes, and what
/// network_findings.hpp finds. Needed is what is read, but for services, for what people publish
/// now and then, and for odometry on one of its two ways, a topic and /tf, when it comes on the
/// other.
[[nodiscard]] Report examine(const Observed& observed);

/// Findings, then participants and topics. all: also the topics of services and the like.
[[nodiscard]] std::string to_text(const Report& report, bool all = false);
[[nodiscard]] std::string to_json(const Report& report);

}  // namespace strata::doctor
