// SPDX-License-Identifier: Apache-2.0
/// Where ROS 2's variables lead us.
#include "components/bus/environment.hpp"

#include <cstdlib>
#include <fstream>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/bus/transports.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"

namespace strata::bus {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class Environment : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE",
                             "ROS_STATIC_PEERS", "ROS_DISTRO", "ROS_DISCOVERY_SERVER"}) {
      unsetenv(name);
    }
  }
  void TearDown() override { SetUp(); }
  static void set(const char* name, const char* value) { setenv(name, value, 1); }
};

TEST_F(Environment, OfNobodyIsTheDefault) {
  const ParticipantOptions options = options_from_environment();
  EXPECT_EQ(options.domain, 0);
  EXPECT_EQ(options.transport, Transport::kDefault);
  EXPECT_EQ(options.ros_distro, "jazzy");
  EXPECT_THAT(options.static_peers, IsEmpty());
  EXPECT_FALSE(options.is_alone);
}

TEST_F(Environment, NamesDomainReleaseAndPeers) {
  set("ROS_DOMAIN_ID", "42");
  set("ROS_DISTRO", "humble");
  set("ROS_STATIC_PEERS", "10.0.0.1;10.0.0.2;");
  const ParticipantOptions options = options_from_environment();
  EXPECT_EQ(options.domain, 42);
  EXPECT_EQ(options.ros_distro, "humble");
  EXPECT_THAT(options.static_peers, ElementsAre("10.0.0.1", "10.0.0.2"));
}

TEST_F(Environment, SaysHowFarToLook) {
  set("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
  EXPECT_EQ(options_from_environment().transport, Transport::kLocalhost);
  for (const char* range : {"SUBNET", "SYSTEM_DEFAULT"}) {
    set("ROS_AUTOMATIC_DISCOVERY_RANGE", range);
    EXPECT_EQ(options_from_environment().transport, Transport::kDefault) << range;
    EXPECT_FALSE(options_from_environment().is_alone) << range;
  }
  set("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF");
  EXPECT_TRUE(options_from_environment().is_alone);
  set("ROS_AUTOMATIC_DISCOVERY_RANGE", "MOON");
  EXPECT_THROW((void)options_from_environment(), ConfigError);
}

TEST_F(Environment, NamesPeersToTheRangesThatAskThem) {
  set("ROS_STATIC_PEERS", "robot;10.0.0.2");
  for (const char* range : {"SUBNET", "LOCALHOST"}) {
    set("ROS_AUTOMATIC_DISCOVERY_RANGE", range);
    EXPECT_THAT(options_from_environment().static_peers, ElementsAre("robot", "10.0.0.2")) << range;
  }
  for (const char* range : {"OFF", "SYSTEM_DEFAULT"}) {
    set("ROS_AUTOMATIC_DISCOVERY_RANGE", range);
    EXPECT_THAT(options_from_environment().static_peers, IsEmpty()) << range;
  }
}

TEST_F(Environment, OfTheOldVariableForLocalhostRulesOverRangeAndPeers) {
  set("ROS_LOCALHOST_ONLY", "1");
  set("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET");
  set("ROS_STATIC_PEERS", "10.0.0.1");
  const ParticipantOptions options = options_from_environment();
  EXPECT_EQ(options.transport, Transport::kLocalhost);
  EXPECT_THAT(options.static_peers, IsEmpty());
  set("ROS_LOCALHOST_ONLY", "0");
  EXPECT_EQ(options_from_environment().transport, Transport::kDefault);
}

TEST_F(Environment, OfTheOldVariableMeansLoopbackToReleasesWithoutARange) {
  set("ROS_LOCALHOST_ONLY", "1");
  set("ROS_DISTRO", "humble");
  EXPECT_EQ(options_from_environment().transport, Transport::kLoopback);
  EXPECT_EQ(options_from_environment("iron").transport, Transport::kLocalhost);
  set("ROS_DISTRO", "kilted");
  EXPECT_EQ(options_from_environment().transport, Transport::kLocalhost);
  EXPECT_EQ(options_from_environment("humble").transport, Transport::kLoopback);
}

TEST_F(Environment, OfAReleaseThatThereIsNotIsNamed) {
  set("ROS_DISTRO", "jazy");
  for (const char* localhost : {"0", "1"}) {
    set("ROS_LOCALHOST_ONLY", localhost);
    try {
      (void)options_from_environment();
      FAIL() << localhost;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.place(), "ROS_DISTRO") << localhost;
    }
    EXPECT_NO_THROW((void)options_from_environment("humble")) << "it is known from elsewhere";
  }
}

TEST_F(Environment, RefusesADomainThatIsNone) {
  for (const char* text : {"x", "233", "-1", "1 "}) {
    set("ROS_DOMAIN_ID", text);
    EXPECT_THROW((void)options_from_environment(), ConfigError) << text;
  }
}

TEST_F(Environment, OfADiscoveryServerNeedsOne) {
  ParticipantOptions options;
  options.transport = Transport::kDiscoveryServer;
  EXPECT_THROW((void)participant_qos(options), ConfigError);
  set("ROS_DISCOVERY_SERVER", "127.0.0.1:11811");
  EXPECT_EQ(options_from_environment().transport, Transport::kDiscoveryServer);
  const auto qos = participant_qos(options);
  const auto& discovery = qos.wire_protocol().builtin.discovery_config;
  EXPECT_EQ(discovery.discoveryProtocol, rtps::DiscoveryProtocol_t::SUPER_CLIENT)
      << "Fast DDS itself would make a client that is told of what matches";
  EXPECT_THAT(discovery.m_DiscoveryServers, SizeIs(1));
  set("ROS_DISCOVERY_SERVER", "no server");
  EXPECT_THROW((void)participant_qos(options), ConfigError);
}

TEST_F(Environment, NeedsADiscoveryServerThatIsFound) {
  ParticipantOptions options;
  options.transport = Transport::kDiscoveryServer;
  options.discovery_server = "127.0.0.1:11811;localhost:11812";
  const auto qos = participant_qos(options);
  const auto& discovery = qos.wire_protocol().builtin.discovery_config;
  EXPECT_EQ(discovery.discoveryProtocol, rtps::DiscoveryProtocol_t::SUPER_CLIENT);
  EXPECT_THAT(discovery.m_DiscoveryServers, SizeIs(2));
  for (const char* servers : {"robot one:11811", "10.0.0.1:port", ";"}) {
    options.discovery_server = servers;
    EXPECT_THROW((void)participant_qos(options), ConfigError) << servers;
  }
}

/// The addresses that a participant with these options asks.
std::vector<std::string> asked(const ParticipantOptions& options) {
  std::vector<std::string> addresses;
  const auto qos = participant_qos(options);
  for (const auto& peer : qos.wire_protocol().builtin.initialPeersList) {
    addresses.push_back(rtps::IPLocator::toIPv4string(peer));
  }
  return addresses;
}

TEST_F(Environment, GivesItsPeersToTheMiddlewareAndKeepsTheMulticastGroup) {
  ParticipantOptions options;
  EXPECT_THAT(asked(options), IsEmpty());
  options.static_peers = {"10.0.0.1", "localhost"};
  EXPECT_THAT(asked(options), ElementsAre("10.0.0.1", "127.0.0.1", "239.255.0.1"));
  options.transport = Transport::kLocalhost;
  options.static_peers = {"10.0.0.1"};
  EXPECT_THAT(asked(options), ElementsAre("10.0.0.1", "127.0.0.1"));
}

TEST_F(Environment, NamesThePeerThatHasNoAddress) {
  ParticipantOptions options;
  options.static_peers = {"10.0.0.1", "robot one"};
  for (const Transport transport : {Transport::kDefault, Transport::kLocalhost, Transport::kWifi}) {
    options.transport = transport;
    try {
      (void)participant_qos(options);
      FAIL() << transport_name(transport);
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.place(), "static peer 'robot one'");
    }
  }
}

TEST_F(Environment, OfLocalhostKeepsEveryInterfaceAndLeavesTheMulticastGroup) {
  ParticipantOptions options;
  options.transport = Transport::kLocalhost;
  const auto qos = participant_qos(options);
  EXPECT_THAT(qos.wire_protocol().builtin.metatrafficMulticastLocatorList, SizeIs(0));
  EXPECT_THAT(qos.wire_protocol().builtin.metatrafficUnicastLocatorList, SizeIs(1));
  EXPECT_FALSE(qos.transport().use_builtin_transports);
  ASSERT_THAT(qos.transport().user_transports, SizeIs(1));
  const auto* udp = dynamic_cast<const eprosima::fastdds::rtps::UDPv4TransportDescriptor*>(
      qos.transport().user_transports.back().get());
  ASSERT_NE(udp, nullptr);
  EXPECT_THAT(udp->interfaceWhiteList, IsEmpty());
}

TEST_F(Environment, WithStaticPeersStillFindsOthers) {
  ParticipantOptions options;
  options.domain = test::own_domain();
  options.static_peers = {"127.0.0.1"};
  const auto here = std::make_shared<Participant>(options);
  const auto there = test::make_participant();
  const RawWriter writer(here, "/scan", "sensor_msgs/msg/LaserScan", qos_profile("default"));
  const RawReader reader(there, "/scan", "sensor_msgs/msg/LaserScan", qos_profile("default"),
                         [](const RawMessage&) {});
  EXPECT_TRUE(writer.wait_for_readers(1, std::chrono::seconds(20)));
}

/// Whether all that these options give the middleware to talk through is one UDP transport, which
/// asks as many processes of a host as ROS 2 does where nothing is multicast.
bool is_udp_only(const ParticipantOptions& options) {
  constexpr std::uint32_t kProcesses = 32;
  const auto qos = participant_qos(options);
  const auto& own = qos.transport().user_transports;
  if (qos.transport().use_builtin_transports || own.size() != 1) return false;
  const auto* udp =
      dynamic_cast<const eprosima::fastdds::rtps::UDPv4TransportDescriptor*>(own.front().get());
  return udp != nullptr && udp->max_initial_peers_range() == kProcesses;
}

TEST_F(Environment, OfAProfileWithoutSharedMemoryIsKeptByLocalhostAndByPeers) {
  set("FASTRTPS_DEFAULT_PROFILES_FILE", STRATA_SOURCE_DIR "/packaging/udp_only.xml");
  // The middleware reads them once a process, so this needs one of its own.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        ParticipantOptions options;
        const bool by_default = is_udp_only(options);
        options.static_peers = {"10.0.0.1"};
        const bool with_peers = is_udp_only(options);
        options.transport = Transport::kLocalhost;
        std::exit(by_default && with_peers && is_udp_only(options) ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
  unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
}

TEST_F(Environment, HandsTheUsersProfilesOnToTheMiddleware) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "profiles.xml";
  std::ofstream(file) << R"(<?xml version="1.0" encoding="UTF-8" ?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="own" is_default_profile="true">
    <rtps><sendSocketBufferSize>123456</sendSocketBufferSize></rtps>
  </participant>
</profiles>)";
  set("FASTRTPS_DEFAULT_PROFILES_FILE", file.c_str());
  // The middleware reads them once a process, so this needs one of its own.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const auto qos = participant_qos(ParticipantOptions());
        const bool is_theirs = qos.transport().send_socket_buffer_size == 123456U;
        const bool is_ours = std::string(qos.name().c_str()) == "/";
        std::exit(is_theirs && is_ours ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
  unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
}

}  // namespace
}  // namespace strata::bus
