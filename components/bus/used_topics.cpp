// SPDX-License-Identifier: Apache-2.0
// The middleware's topics, which endpoints share and give back.
#include <algorithm>

#include "components/bus/names.hpp"
#include "components/bus/participant_state.hpp"
#include "components/bus/raw_type.hpp"
#include "core/base/error.hpp"

namespace strata::bus {

dds::Topic* Participant::State::topic(const TopicName& name, const std::string& type) {
  const std::lock_guard lock(mutex);
  const std::string wire_name = wire_topic(name);
  if (before_endpoint) before_endpoint(wire_name);
  if (const auto found = topics.find(wire_name); found != topics.end()) {
    UsedTopic& used = found->second;
    if (used.topic->get_type_name() != wire_type(type)) {
      throw ConfigError(
          name.full,
          "carries " + type_from_wire(used.topic->get_type_name()) + " and is asked for as " + type,
          "remap one of the two topics");
    }
    ++used.endpoints;
    return used.topic;
  }
  const std::string type_name = wire_type(type);
  if (participant->find_type(type_name).empty()) {
    participant->register_type(dds::TypeSupport(new RawType(type_name)));
  }
  const auto entry = topics.try_emplace(wire_name).first;  // before what it is to keep is made
  entry->second = {participant->create_topic(wire_name, type_name, dds::TOPIC_QOS_DEFAULT), 1};
  if (entry->second.topic == nullptr) {
    topics.erase(entry);
    throw OutputError(name.full, "the topic cannot be made", "check its name and type " + type);
  }
  offers_now.reset();  // what it can read of the topic has changed
  return entry->second.topic;
}

void Participant::State::give_back(dds::Topic* topic) {
  if (topic == nullptr) return;
  const std::lock_guard lock(mutex);
  const auto used = std::find_if(topics.begin(), topics.end(),
                                 [&](const auto& entry) { return entry.second.topic == topic; });
  if (used == topics.end() || --used->second.endpoints > 0) return;
  // Where the middleware still holds on to it, the next endpoint of that name takes it.
  if (participant->delete_topic(topic) != eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
    return;
  }
  topics.erase(used);
  offers_now.reset();
}

}  // namespace strata::bus
