// SPDX-License-Identifier: Apache-2.0
/// What the bus keeps of Fast DDS; for the bus's own .cpp files only.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "components/bus/caught.hpp"
#include "components/bus/names.hpp"
#include "components/bus/participant.hpp"
#include "components/bus/shared_ports.hpp"

namespace strata::bus {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

class GraphWriter;

[[nodiscard]] inline Guid to_guid(const rtps::GUID_t& guid) {
  Guid result{};
  std::copy_n(guid.guidPrefix.value, 12, result.begin());
  std::copy_n(guid.entityId.value, 4, result.begin() + 12);
  return result;
}

/// What stands behind `key`= in user data of ROS 2 ("enclave=/;"); empty where it does not.
[[nodiscard]] std::string user_data_value(const std::vector<rtps::octet>& user_data,
                                          const std::string& key);

/// 0 for one without limit.
[[nodiscard]] inline double seconds_of(const eprosima::fastrtps::Duration_t& duration) {
  if (duration == eprosima::fastrtps::c_TimeInfinite) return 0.0;
  return static_cast<double>(duration.to_ns()) * 1e-9;
}

[[nodiscard]] inline Liveliness liveliness_of(dds::LivelinessQosPolicyKind kind) {
  if (kind == dds::AUTOMATIC_LIVELINESS_QOS) return Liveliness::kAutomatic;
  return kind == dds::MANUAL_BY_TOPIC_LIVELINESS_QOS ? Liveliness::kManualByTopic
                                                     : Liveliness::kUnknown;
}

/// The endpoint as it announces itself; info: a reader's or writer's proxy data.
template <typename ProxyData>
[[nodiscard]] DiscoveredEndpoint describe_endpoint(const ProxyData& info, bool writes) {
  DiscoveredEndpoint endpoint;
  endpoint.guid = to_guid(info.guid());
  endpoint.writes = writes;
  endpoint.wire_topic = info.topicName().to_string();
  endpoint.wire_type = info.typeName().to_string();
  endpoint.reliable = info.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  endpoint.transient_local = info.m_qos.m_durability.kind >= dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  endpoint.deadline_s = seconds_of(info.m_qos.m_deadline.period);
  endpoint.lifespan_s = seconds_of(info.m_qos.m_lifespan.duration);
  endpoint.liveliness = liveliness_of(info.m_qos.m_liveliness.kind);
  endpoint.lease_s = seconds_of(info.m_qos.m_liveliness.lease_duration);
  endpoint.type_hash = user_data_value(info.m_qos.m_userData.getValue(), "typehash");
  return endpoint;
}

struct Participant::State : dds::DomainParticipantListener {
  ParticipantOptions options;
  bool is_secured = false;
  /// Where memory is shared; given up after the participant.
  std::unique_ptr<SharedPortClaim> shared_ports;
  std::optional<int> alone_id;  ///< of one that nobody sees (ProcessParticipants)
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;
  [[nodiscard]] bool uses_shared_memory() const;
  /// The topic's entity, for one endpoint more: Fast DDS allows one a name.
  dds::Topic* topic(const TopicName& name, const std::string& type);
  /// An endpoint less has it; it goes with the last one, and its name may have another type then.
  /// Never throws.
  void give_back(dds::Topic* topic);
  /// Fast DDS announces only the endpoints of others.
  void add_endpoint(const DiscoveredEndpoint& endpoint);
  void remove_endpoint(const Guid& guid);

  void on_participant_discovery(dds::DomainParticipant* participant,
                                rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(dds::DomainParticipant* participant,
                              rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(dds::DomainParticipant* participant,
                               rtps::ReaderDiscoveryInfo&& info) override;
  void take_participant(const rtps::ParticipantDiscoveryInfo& info);

  /// Returns when it no longer sees that participant or is ending itself, or at the deadline.
  void wait_until_forgotten(const Guid& guid, std::chrono::steady_clock::time_point deadline);
  /// It is ending: nobody need wait for it.
  void leave();
  /// What all endpoints that are known publish, under `mutex`.
  [[nodiscard]] std::map<std::string, PublishedTopic> offers() const;

  Caught caught;  // by callbacks of the middleware

  mutable std::mutex mutex;
  std::condition_variable forgot;  // one of `participants`
  bool is_leaving = false;
  std::function<void(const std::string&)> before_endpoint;  // see Participant
  struct UsedTopic {
    dds::Topic* topic = nullptr;
    std::size_t endpoints = 0;
  };
  std::map<std::string, UsedTopic> topics;                          // by wire name
  std::map<Guid, DiscoveredParticipant> participants;               // of others
  std::map<Guid, DiscoveredEndpoint> endpoints;                     // own and others'
  std::optional<std::map<std::string, PublishedTopic>> offers_now;  // of those; none: to be made

  std::mutex graph_mutex;
  std::weak_ptr<GraphWriter> graph;  // lives with the nodes it announces
};

}  // namespace strata::bus
