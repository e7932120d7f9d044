// SPDX-License-Identifier: Apache-2.0
/// What a participant gives the middleware to talk through.
#include "components/bus/transports.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/participant.hpp"
#include "components/bus/shared_ports.hpp"
#include "tests/components/bus/domain.hpp"

namespace strata::bus {
namespace {

using testing::HasSubstr;
using Udp = eprosima::fastdds::rtps::UDPv4TransportDescriptor;

dds::DomainParticipantQos qos_of(Transport transport) {
  ParticipantOptions options;
  options.transport = transport;
  options.discovery_server = "127.0.0.1:11811";
  return participant_qos(options);
}

const Udp* only_udp(const dds::DomainParticipantQos& qos) {
  const auto& own = qos.transport().user_transports;
  if (qos.transport().use_builtin_transports || own.size() != 1) return nullptr;
  return dynamic_cast<const Udp*>(own.front().get());
}

TEST(Transports, AreUdpOnlyWhereSharedMemoryIsNotAskedFor) {
  for (const Transport transport :
       {Transport::kDefault, Transport::kLocalhost, Transport::kLoopback, Transport::kWifi,
        Transport::kDiscoveryServer, Transport::kAlone}) {
    const auto qos = qos_of(transport);
    const Udp* udp = only_udp(qos);
    ASSERT_NE(udp, nullptr) << transport_name(transport);
    EXPECT_EQ(udp->sendBufferSize, 4U << 20U) << transport_name(transport);
    EXPECT_EQ(udp->receiveBufferSize, 4U << 20U) << transport_name(transport);
    EXPECT_EQ(udp->max_initial_peers_range(), 32U) << transport_name(transport);
  }
  EXPECT_EQ(only_udp(qos_of(Transport::kSharedMemory)), nullptr);
}

// Fast DDS 2.9 aborts where two readers share a group (tests/network/strangers_test.cpp).
TEST(Transports, KeepNoMulticastAddressOfOthers) {
  for (const Transport transport :
       {Transport::kDefault, Transport::kLocalhost, Transport::kLoopback, Transport::kSharedMemory,
        Transport::kWifi, Transport::kDiscoveryServer, Transport::kAlone}) {
    EXPECT_EQ(qos_of(transport).allocation().locators.max_multicast_locators, 0U)
        << transport_name(transport);
  }
}

TEST(Transports, OfSharedMemoryHavePortsOfTheirOwn) {
  const auto& port = qos_of(Transport::kSharedMemory).wire_protocol().port;
  EXPECT_EQ(port.getUnicastPort(0, 0), 7362U);
  EXPECT_EQ(port.getMulticastPort(0), 7398U);
  EXPECT_EQ(port.getUnicastPort(232, 17), 65379U);
}

TEST(Transports, OfAProfileThatSharesMemoryAreKeptAndWarnedOf) {
  setenv("FASTRTPS_DEFAULT_PROFILES_FILE", STRATA_SOURCE_DIR "/tests/network/ros2_fastdds.xml", 1);
  // The middleware reads them once a process, so this needs one of its own.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const auto participant = test::make_participant(Transport::kDefault);
        const auto warnings = participant->warnings();
        if (warnings.size() == 1) std::fputs(warnings.front().c_str(), stderr);
        std::_Exit(0);
      },
      testing::ExitedWithCode(0), HasSubstr("a Fast DDS profile of yours shares memory"));
  unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
}

TEST(Transports, AskedForByNameGiveNoWarning) {
  for (const Transport transport : {Transport::kDefault, Transport::kSharedMemory}) {
    EXPECT_TRUE(test::make_participant(transport)->warnings().empty());
  }
}

}  // namespace
}  // namespace strata::bus
