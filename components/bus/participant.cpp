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
    case Transport::kAlone:
      use_loopback(qos);
      discovery.discoveryProtocol = rtps::DiscoveryProtocol_t::NONE;
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

/// "enclave=/robot;" -> "/robot".
std::string enclave_of(const std::string& user_data) {
  const std::string key = "enclave=";
  const std::size_t begin = user_data.find(key);
  if (begin == std::string::npos) return {};
  const std::size_t first = begin + key.size();
  return user_data.substr(first, user_data.find(';', first) - first);
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

Guid Participant::guid() const { return to_guid(state_->participant->guid()); }

std::map<std::string, PublishedTopic> Participant::published_topics() const {
  const std::lock_guard lock(state_->mutex);
  std::map<std::string, PublishedTopic> result;
  for (const auto& [guid, endpoint] : state_->endpoints) {
    const std::string topic = topic_from_wire(endpoint.wire_topic);
    const std::string type = type_from_wire(endpoint.wire_type);
    if (!endpoint.writes || topic.empty() || type.empty()) continue;
    const PublishedTopic offered{type, endpoint.reliable, endpoint.transient_local};
    const auto [entry, is_first] = result.insert({topic, offered});
    if (is_first) continue;
    PublishedTopic& published = entry->second;
    published.reliable = published.reliable && offered.reliable;
    published.transient_local = published.transient_local && offered.transient_local;
  }
  return result;
}

DomainView Participant::view() const {
  const std::lock_guard lock(state_->mutex);
  DomainView view;
  view.participants.push_back({guid(), state_->options.enclave, state_->options.enclave});
  for (const auto& [guid, participant] : state_->participants) {
    view.participants.push_back(participant);
  }
  for (const auto& [guid, endpoint] : state_->endpoints) view.endpoints.push_back(endpoint);
  return view;
}

dds::Topic* Participant::State::topic(const TopicName& name, const std::string& type) {
  const std::lock_guard lock(mutex);
  const std::string wire_name = wire_topic(name);
  if (const auto found = topics.find(wire_name); found != topics.end()) {
    if (found->second->get_type_name() != wire_type(type)) {
      throw ConfigError(name.full,
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
  dds::Topic* made = participant->create_topic(wire_name, type_name, dds::TOPIC_QOS_DEFAULT);
  if (made == nullptr) {
    throw OutputError(name.full, "the topic cannot be made", "check its name and type " + type);
  }
  topics[wire_name] = made;
  return made;
}

void Participant::State::add_endpoint(const DiscoveredEndpoint& endpoint) {
  const std::lock_guard lock(mutex);
  endpoints[endpoint.guid] = endpoint;
}

void Participant::State::remove_endpoint(const Guid& guid) {
  const std::lock_guard lock(mutex);
  endpoints.erase(guid);
}

void Participant::State::on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                                  rtps::ParticipantDiscoveryInfo&& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  const Guid guid = to_guid(info.info.m_guid);
  const std::lock_guard lock(mutex);
  if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
    participants.erase(guid);
    return;
  }
  const std::vector<rtps::octet>& data = info.info.m_userData.getValue();
  participants[guid] = {guid, info.info.m_participantName.to_string(),
                        enclave_of(std::string(data.begin(), data.end()))};
}

void Participant::State::on_publisher_discovery(dds::DomainParticipant* /*participant*/,
                                                rtps::WriterDiscoveryInfo&& info) {
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    remove_endpoint(to_guid(info.info.guid()));
  } else {
    add_endpoint(describe_endpoint(info.info, true));
  }
}

void Participant::State::on_subscriber_discovery(dds::DomainParticipant* /*participant*/,
                                                 rtps::ReaderDiscoveryInfo&& info) {
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    remove_endpoint(to_guid(info.info.guid()));
  } else {
    add_endpoint(describe_endpoint(info.info, false));
  }
}

}  // namespace strata::bus
