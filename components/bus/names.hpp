// SPDX-License-Identifier: Apache-2.0
/// ROS 2 names: how a topic or type that a component names is spelled in full and on the wire.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace strata::bus {

/// From what a component calls a topic to what it is to be called.
using Remappings = std::map<std::string, std::string>;

/// The full name ("/robot1/scan") of "scan", "/scan" or "~/scan" for a node. Throws ConfigError for
/// an empty name or characters that ROS 2 does not allow.
[[nodiscard]] std::string expand_name(const std::string& name, const std::string& node_namespace,
                                      const std::string& node_name);

/// As expand_name, after remapping: a rule applies when its left side expands to the same name.
[[nodiscard]] std::string resolve_name(const std::string& name, const std::string& node_namespace,
                                       const std::string& node_name, const Remappings& remappings);

enum class TopicKind {
  kTopic,    ///< "rt" in front
  kRequest,  ///< what a service is asked: "rq" in front, "Request" behind
  kReply,    ///< what it answers: "rr" in front, "Reply" behind
  kPlain     ///< as it is: not a ROS 2 topic by its name
};

/// What an endpoint is on: a full name, "/robot1/scan", and what kind of topic that is.
struct TopicName {
  TopicName(std::string full_name, TopicKind topic_kind = TopicKind::kTopic)  // NOLINT: implicit
      : full(std::move(full_name)), kind(topic_kind) {}
  TopicName(const char* full_name) : full(full_name) {}  // NOLINT(google-explicit-constructor)
  [[nodiscard]] static TopicName plain(std::string name) {
    return {std::move(name), TopicKind::kPlain};
  }
  std::string full;
  TopicKind kind = TopicKind::kTopic;
};

/// "rt/robot1/scan" for "/robot1/scan".
[[nodiscard]] std::string wire_topic(const TopicName& name);
/// "/robot1/scan" for "rt/robot1/scan"; empty for a name that is not a ROS 2 topic.
[[nodiscard]] std::string topic_from_wire(std::string_view wire_name);

/// "sensor_msgs::msg::dds_::LaserScan_" for "sensor_msgs/msg/LaserScan".
[[nodiscard]] std::string wire_type(std::string_view ros_type);
/// The reverse; empty for a name of another shape.
[[nodiscard]] std::string type_from_wire(std::string_view wire_name);

}  // namespace strata::bus
