// SPDX-License-Identifier: Apache-2.0
#include "components/log/ros1_topics.hpp"

#include <algorithm>
#include <utility>

#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"

namespace strata::log {

std::string Ros1Topics::add(const Ros1Fields& fields, View data) {
  const auto id = fields.number<std::uint32_t>("conn");
  const Ros1Fields about(data);
  BagTopic topic;
  topic.name = fields.text("topic");
  const std::string type = about.text("type");
  if (!id || !about.ok() || topic.name.empty() || type.empty()) {
    return "a connection is not readable";
  }
  if (connections_.contains(*id)) return "";
  std::string problem;
  const auto known = find_ros1_type(type, about.text("md5sum"));
  topic.type = known ? known->ros2_type : type;
  if (!known) {
    topic.serialization_format = kRos1Format;
    topic.definition = about.text("message_definition");
    topic.definition_encoding = "ros1msg";
    if (find_ros1_type(type, "*")) {
      problem = topic.name + " is not read: its " + type + " is another than ROS 1's (md5sum " +
                about.text("md5sum") + ")";
    }
  }
  const bool is_latched = about.text("latching") == "1" || topic.name == "/tf_static";
  topic.offered_qos_profiles = recorded_qos(is_latched);
  const auto same = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& other) {
    return other.name == topic.name && other.type == topic.type;
  });
  connections_[*id] = {static_cast<std::size_t>(same - topics_.begin()), known};
  if (same == topics_.end()) topics_.push_back(std::move(topic));
  return problem;
}

BagMessage Ros1Topics::message(const Ros1Fields& fields, View data,
                               const std::string& place) const {
  const auto id = fields.number<std::uint32_t>("conn");
  const auto stamp = fields.time("time");
  const auto found = id ? connections_.find(*id) : connections_.end();
  if (found == connections_.end() || !stamp) {
    throw InputError(place, "a message is not readable or belongs to no topic",
                     "check that the bag was copied whole");
  }
  const auto& [topic, type] = found->second;
  BagMessage message{topic, *stamp, {}};
  message.data = type ? ros1_to_cdr(*type, data, place + ": " + topics_[topic].name)
                      : Bytes(data.begin(), data.end());
  return message;
}

}  // namespace strata::log
