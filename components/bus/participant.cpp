// SPDX-License-Identifier: Apache-2.0
#include "components/bus/participant.hpp"

#include <array>
#include <cstdlib>
#include <vector>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "components/bus/names.hpp"
#include "components/bus/participant_state.hpp"
#include "components/bus/raw_type.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

constexpr std::array<std::pair<Transport, const char*>, 4> kTransports = {
    {{Transport::kDefault, "default"},
     {Transport::kLoopback, "loopback"},
     {Transport::kSharedMemory, "shared_memory"},
     {Transport::kDiscoveryServer, "discovery_server"}}};

// A 4 MB map must fit into a socket's buffer and, many times, into the shared segment.
constexpr std::uint32_t kSocketBufferBytes = 4U << 20U;
constexpr std::uint32_t kSharedSegmentBytes = 64U << 20U;

void use_loopback(dds::DomainParticipantQos& qos) {
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  udp->sendBufferSize = kSocketBufferBytes;
  udp->receiveBufferSize = kSocketBufferBytes;
  udp->maxInitialPeersRange = 32;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  auto& builtin = qos.wire_protocol().builtin;
  // An empty unicast locator keeps the default multicast one away; peers are asked one by one.
  builtin.metatrafficUnicastLocatorList.push_back(rtps::Locator_t());
  rtps::Locator_t peer;
  peer.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(peer, "127.0.0.1");
  builtin.initialPeersList.push_back(peer);
}

void use_shared_memory(dds::DomainParticipantQos& qos) {
  auto shared = std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>();
  shared->segment_size(kSharedSegmentBytes);
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(shared);
}

dds::DomainParticipantQos participant_qos(const ParticipantOptions& options) {
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  qos.name(options.enclave);
  // With the trailing NUL, as ROS 2's own Fast DDS layer sends it.
  const std::string user_data = "enclave=" + options.enclave + ";";
  std::vector<rtps::octet> bytes(user_data.begin(), user_data.end());
  bytes.push_back(0);
  qos.user_data().setValue(bytes);
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  // The default of 3 s makes a late starter wait that long.
  discovery.leaseDuration_announcementperiod = eprosima::fastrtps::Duration_t(0, 100'000'000);
  discovery.initial_announcements.count = 5;
  discovery.initial_announcements.period = eprosima::fastrtps::Duration_t(0, 50'000'000);
  switch (options.transport) {
    case Transport::kLoopback:
      use_loopback(qos);
      break;
    case Transport::kSharedMemory:
      use_shared_memory(qos);
      break;
    case Transport::kDefault:
      break;
    case Transport::kDiscoveryServer:
      // Fast DDS itself reads the variable; without it we would silently multicast.
      if (std::getenv("ROS_DISCOVERY_SERVER") == nullptr) {
        throw ConfigError("transport", "discovery_server needs the address of a server",
                          "set ROS_DISCOVERY_SERVER=host:port");
      }
      break;
  }
  return qos;
}

}  // namespace

Transport transport_from_name(std::string_view name) {
  for (const auto& [transport, candidate] : kTransports) {
    if (name == candidate) return transport;
  }
  throw ConfigError("transport", "unknown transport '" + std::string(name) + "'",
                    "use default, loopback, shared_memory or discovery_server");
}

Participant::Participant(const ParticipantOptions& options) : state_(std::make_unique<State>()) {
  if (options.domain < 0 || options.domain > 232) {
    throw ConfigError("domain", "is " + std::to_string(options.domain),
                      "choose a ROS_DOMAIN_ID from 0 to 232");
  }
  state_->options = options;
  const dds::DomainParticipantQos qos = participant_qos(options);
  auto* factory = dds::DomainParticipantFactory::get_instance();
  state_->participant = factory->create_participant(static_cast<dds::DomainId_t>(options.domain),
                                                    qos, state_.get(), dds::StatusMask::none());
  if (state_->participant != nullptr) {
    state_->publisher = state_->participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    state_->subscriber = state_->participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  if (state_->publisher == nullptr || state_->subscriber == nullptr) {
    throw OutputError("domain " + std::to_string(options.domain), "no DDS participant can be made",
                      "check the network interfaces and free ports above 7400");
  }
}

Participant::~Participant() {
  if (state_->participant == nullptr) return;
  state_->participant->set_listener(nullptr);
  state_->participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(state_->participant);
}

const ParticipantOptions& Participant::options() const { return state_->options; }

std::map<std::string, PublishedTopic> Participant::published_topics() const {
  const std::lock_guard lock(state_->mutex);
  std::map<std::string, PublishedTopic> result;
  for (const auto& [guid, writer] : state_->writers) {
    const auto [entry, is_first] = result.insert(writer);
    if (is_first) continue;
    PublishedTopic& published = entry->second;
    published.reliable = published.reliable && writer.second.reliable;
    published.transient_local = published.transient_local && writer.second.transient_local;
  }
  return result;
}

dds::Topic* Participant::State::topic(const std::string& full_name, const std::string& type) {
  const std::lock_guard lock(mutex);
  if (const auto found = topics.find(full_name); found != topics.end()) {
    if (found->second->get_type_name() != wire_type(type)) {
      throw ConfigError(full_name,
                        "carries " + type_from_wire(found->second->get_type_name()) +
                            " and is asked for as " + type,
                        "remap one of the two topics");
    }
    return found->second;
  }
  const std::string type_name = wire_type(type);
  if (participant->find_type(type_name).empty()) {
    participant->register_type(dds::TypeSupport(new RawType(type_name)));
  }
  dds::Topic* made =
      participant->create_topic(wire_topic(full_name), type_name, dds::TOPIC_QOS_DEFAULT);
  if (made == nullptr) {
    throw OutputError(full_name, "the topic cannot be made", "check its name and type " + type);
  }
  topics[full_name] = made;
  return made;
}

void Participant::State::add_local_writer(const rtps::GUID_t& guid, const std::string& full_name,
                                          const PublishedTopic& published) {
  const std::lock_guard lock(mutex);
  writers[guid] = {full_name, published};
}

void Participant::State::remove_local_writer(const rtps::GUID_t& guid) {
  const std::lock_guard lock(mutex);
  writers.erase(guid);
}

void Participant::State::on_publisher_discovery(dds::DomainParticipant* /*participant*/,
                                                rtps::WriterDiscoveryInfo&& info) {
  const std::string topic = topic_from_wire(info.info.topicName().to_string());
  const std::string type = type_from_wire(info.info.typeName().to_string());
  if (topic.empty() || type.empty()) return;
  const std::lock_guard lock(mutex);
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    writers.erase(info.info.guid());
  } else {
    const auto& qos = info.info.m_qos;
    writers[info.info.guid()] = {topic,
                                 {type, qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS,
                                  qos.m_durability.kind >= dds::TRANSIENT_LOCAL_DURABILITY_QOS}};
  }
}

}  // namespace strata::bus
