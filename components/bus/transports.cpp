// SPDX-License-Identifier: Apache-2.0
#include "components/bus/transports.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "components/bus/shared_ports.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

constexpr std::array<std::pair<Transport, const char*>, 6> kTransports = {
    {{Transport::kDefault, "default"},
     {Transport::kLocalhost, "localhost"},
     {Transport::kLoopback, "loopback"},
     {Transport::kSharedMemory, "shared_memory"},
     {Transport::kWifi, "wifi"},
     {Transport::kDiscoveryServer, "discovery_server"}}};

// A 4 MB map must fit into a socket's buffer and, many times, into the shared segment.
constexpr std::uint32_t kSocketBufferBytes = 4U << 20U;
constexpr std::uint32_t kSharedSegmentBytes = 64U << 20U;
// How many processes are asked of a host whose multicast group is not used.
constexpr std::uint32_t kProcessesOfAPeer = 32;

rtps::Locator_t ipv4_locator(const std::string& address) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(locator, address);
  return locator;
}

/// UDP for 4 MB maps; asks enough processes of a host whose multicast group is not used. Buffer
/// sizes that a profile of the user's names are kept.
std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> make_udp(
    const dds::TransportConfigQos& given) {
  const auto size = [](std::uint32_t named) { return named > 0 ? named : kSocketBufferBytes; };
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->sendBufferSize = size(given.send_socket_buffer_size);
  udp->receiveBufferSize = size(given.listen_socket_buffer_size);
  udp->maxInitialPeersRange = kProcessesOfAPeer;
  return udp;
}

void use_only(const std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>& one,
              dds::TransportConfigQos& transport) {
  transport.use_builtin_transports = false;
  transport.user_transports = {one};
}

/// No shared memory: Fast DDS trusts what it finds there, so a process of another release, or a
/// file that any user of the host puts into /dev/shm, ends ours (docs/networks.md). Where a profile
/// of the user's says which transports to use, those stay as they are, as in rmw_fastrtps (its
/// participant.cpp).
void use_udp(dds::DomainParticipantQos& qos) {
  auto& transport = qos.transport();
  if (!transport.use_builtin_transports || !transport.user_transports.empty()) return;
  use_only(make_udp(transport), transport);
}

/// As rmw_fastrtps since Iron: every interface, so that static peers are reached and nodes of the
/// default range are met, but no multicast group.
void use_localhost(dds::DomainParticipantQos& qos) {
  auto& builtin = qos.wire_protocol().builtin;
  builtin.metatrafficMulticastLocatorList.clear();
  // An empty unicast locator keeps the default multicast one away.
  builtin.metatrafficUnicastLocatorList.push_back(rtps::Locator_t());
  builtin.initialPeersList.push_back(ipv4_locator("127.0.0.1"));
  use_udp(qos);
}

void use_loopback(dds::DomainParticipantQos& qos) {
  auto udp = make_udp(qos.transport());
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  use_only(udp, qos.transport());
  auto& builtin = qos.wire_protocol().builtin;
  // An empty unicast locator keeps the default multicast one away; peers are asked one by one.
  builtin.metatrafficUnicastLocatorList.push_back(rtps::Locator_t());
  builtin.initialPeersList.push_back(ipv4_locator("127.0.0.1"));
}

// What an Ethernet frame carries (1500), less IP's and UDP's headers.
constexpr std::uint32_t kFrameBytes = 1472;

/// Sends datagrams that fit one frame, and takes those of any size: what a transport receives goes
/// by its own maxMessageSize, what a participant sends by what its descriptor says here.
struct FrameDescriptor : eprosima::fastdds::rtps::UDPv4TransportDescriptor {
  explicit FrameDescriptor(const UDPv4TransportDescriptor& udp) : UDPv4TransportDescriptor(udp) {}
  [[nodiscard]] std::uint32_t max_message_size() const override { return kFrameBytes; }
};

/// A datagram of 64 KB travels as 45 frames and is lost with any of them: where one frame in ten is
/// lost, 99 of 100 datagrams are, and a map never arrives. So DDS cuts, and asks again for the
/// pieces it misses.
void use_small_datagrams(dds::DomainParticipantQos& qos) {
  use_only(std::make_shared<FrameDescriptor>(*make_udp(qos.transport())), qos.transport());
}

void use_shared_memory(dds::DomainParticipantQos& qos) {
  auto shared = std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>();
  shared->segment_size(kSharedSegmentBytes);
  use_only(shared, qos.transport());
  auto& port = qos.wire_protocol().port;
  port.portBase = kSharedPorts.base;
  port.participantIDGain = 1;
  port.offsetd1 = kSharedPorts.discovery;
  port.offsetd3 = kSharedPorts.user;
  port.offsetd0 = kSharedPorts.all_discovery;
  port.offsetd2 = kSharedPorts.all_user;
}

/// Asks these hosts too, each at the first IPv4 address of its name, as ROS 2 does.
void add_peers(const std::vector<std::string>& peers, dds::DomainParticipantQos& qos) {
  auto& list = qos.wire_protocol().builtin.initialPeersList;
  for (const std::string& peer : peers) {
    const auto addresses = rtps::IPLocator::resolveNameDNS(peer).first;
    if (addresses.empty()) {
      throw ConfigError("static peer '" + peer + "'", "has no IPv4 address",
                        "write addresses, or names that `getent ahostsv4 NAME` knows, into "
                        "static_peers or ROS_STATIC_PEERS");
    }
    list.push_back(ipv4_locator(*addresses.begin()));
  }
}

/// Adds peers to a transport with multicast. A list of peers takes the place of the multicast
/// group, so that joins it.
void add_peers_and_group(const std::vector<std::string>& peers, dds::DomainParticipantQos& qos) {
  if (peers.empty()) return;
  add_peers(peers, qos);
  qos.wire_protocol().builtin.initialPeersList.push_back(ipv4_locator("239.255.0.1"));
}

/// As a client that is told of everybody: a plain one hears of the endpoints that match its own, so
/// that what looks at the whole domain (recorders, the live view, the doctor) would find nothing.
void use_discovery_server(const std::string& named, dds::DomainParticipantQos& qos) {
  use_udp(qos);
  // Fast DDS would read the variable itself, and make a plain client.
  const char* variable = std::getenv("ROS_DISCOVERY_SERVER");
  const std::string servers = named.empty() && variable != nullptr ? variable : named;
  if (servers.empty()) {
    throw ConfigError("transport", "discovery_server needs the address of a server",
                      "write discovery_server: HOST:PORT, or set ROS_DISCOVERY_SERVER=HOST:PORT");
  }
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  auto& list = discovery.m_DiscoveryServers;
  const bool is_list = eprosima::fastdds::rtps::load_environment_server_info(servers, list);
  const bool has_addresses = std::all_of(list.begin(), list.end(), [](const auto& server) {
    return server.template requires_transport<LOCATOR_KIND_UDPv4>();
  });
  if (!is_list || list.empty() || !has_addresses) {
    throw ConfigError(named.empty() ? "ROS_DISCOVERY_SERVER" : "discovery_server",
                      "'" + servers + "' is no list of servers that are found",
                      "write IPv4 addresses or host names, as 10.0.0.5:11811, with ';' between");
  }
  // With another protocol than the simple one Fast DDS leaves the variable alone.
  discovery.discoveryProtocol = rtps::DiscoveryProtocol_t::SUPER_CLIENT;
}

void use_transport(const ParticipantOptions& options, dds::DomainParticipantQos& qos) {
  switch (options.transport) {
    case Transport::kLocalhost:
      add_peers(options.static_peers, qos);
      use_localhost(qos);
      break;
    case Transport::kLoopback:
      use_loopback(qos);
      break;
    case Transport::kSharedMemory:
      use_shared_memory(qos);
      break;
    case Transport::kAlone:
      use_loopback(qos);
      qos.wire_protocol().builtin.discovery_config.discoveryProtocol =
          rtps::DiscoveryProtocol_t::NONE;
      break;
    case Transport::kWifi:
      use_small_datagrams(qos);
      add_peers_and_group(options.static_peers, qos);
      break;
    case Transport::kDefault:
      use_udp(qos);
      add_peers_and_group(options.static_peers, qos);
      break;
    case Transport::kDiscoveryServer:
      use_discovery_server(options.discovery_server, qos);
      break;
  }
}

}  // namespace

dds::DomainParticipantQos participant_qos(const ParticipantOptions& options) {
  // What FASTRTPS_DEFAULT_PROFILES_FILE says, where it does.
  auto* factory = dds::DomainParticipantFactory::get_instance();
  factory->load_profiles();
  dds::DomainParticipantQos qos = factory->get_default_participant_qos();
  qos.name(options.enclave);
  // With the trailing NUL, as ROS 2's own Fast DDS layer sends it.
  const std::string user_data = "enclave=" + options.enclave + ";";
  std::vector<rtps::octet> bytes(user_data.begin(), user_data.end());
  bytes.push_back(0);
  qos.user_data().setValue(bytes);
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  // A new participant is answered at once; where all its first announcements are lost, it waits so
  // long, by default 3 s. Each goes to every port that may be somebody's: 32 without multicast.
  discovery.leaseDuration_announcementperiod = eprosima::fastrtps::Duration_t(1, 0);
  discovery.initial_announcements.count = 5;
  discovery.initial_announcements.period = eprosima::fastrtps::Duration_t(0, 50'000'000);
  // Of readers that share a multicast group Fast DDS 2.9 selects the group only, and sends each new
  // one its first heartbeat to an address of its own that it never registered; an assertion ends
  // the process. Two ROS 2 nodes on Cyclone DDS are enough. Mended in 2.10.7, 2.14.5 and 3.1.3
  // (https://github.com/eProsima/Fast-DDS/pull/5704). So nobody's multicast addresses are kept.
  qos.allocation().locators.max_multicast_locators = 0;
  use_transport(options, qos);
  if (options.is_alone) {
    discovery.ignoreParticipantFlags = static_cast<rtps::ParticipantFilteringFlags_t>(
        rtps::ParticipantFilteringFlags::FILTER_DIFFERENT_HOST |
        rtps::ParticipantFilteringFlags::FILTER_DIFFERENT_PROCESS);
  }
  return qos;
}

std::string transport_names() {
  std::string text;
  for (const auto& [transport, name] : kTransports) {
    if (!text.empty()) text += transport == kTransports.back().first ? " or " : ", ";
    text += name;
  }
  return text;
}

Transport transport_from_name(std::string_view name) {
  for (const auto& [transport, candidate] : kTransports) {
    if (name == candidate) return transport;
  }
  throw ConfigError("transport", "unknown transport '" + std::string(name) + "'",
                    "use " + transport_names());
}

std::string_view transport_name(Transport transport) {
  for (const auto& [candidate, name] : kTransports) {
    if (transport == candidate) return name;
  }
  return "alone";
}

bool asks_static_peers(Transport transport) {
  return transport == Transport::kDefault || transport == Transport::kLocalhost ||
         transport == Transport::kWifi;
}

}  // namespace strata::bus
