// SPDX-License-Identifier: Apache-2.0
/// Who meets whom with ROS 2's ranges of discovery, on one host and on two: the tables of "Improved
/// Dynamic Discovery" in ROS 2's documentation, tried in both directions with data.
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/split.hpp"
#include "tests/network/network_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {
namespace {

using std::chrono::seconds;
using Environment = std::vector<std::string>;

/// One end's variables; "@" is the address of the other end's host.
struct Pair {
  std::string name;
  std::string first;
  std::string second;
  bool on_one_host = true;
  bool meets = true;
};

void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.name; }

Environment environment_of(const std::string& text, const std::string& other_host) {
  Environment result;
  for (std::string& word : split(text, ' ')) {
    if (word.ends_with('@')) word.replace(word.size() - 1, 1, other_host);
    result.push_back("ROS_" + word);
  }
  return result;
}

class DiscoveryRange : public Network, public testing::WithParamInterface<Pair> {
 protected:
  [[nodiscard]] auto person(std::size_t host, int number, const Environment& environment) const {
    return peer(host, {"meet", std::to_string(number)}, "environment", environment);
  }
};

TEST_P(DiscoveryRange, MeetsWhomRos2Says) {
  STRATA_MAKE_HOSTS(2);
  const Pair& pair = GetParam();
  const std::size_t other = pair.on_one_host ? 0 : 1;
  const auto first = person(0, 1, environment_of(pair.first, VirtualNetwork::address(other)));
  const auto second = person(other, 2, environment_of(pair.second, VirtualNetwork::address(0)));
  if (pair.meets) {
    EXPECT_EQ(first->wait_for_line("met 2", kPatience), "met 2");
    EXPECT_EQ(second->wait_for_line("met 1", kPatience), "met 1");
    return;
  }
  // Both hosts are up and see each other: two who came later have met.
  const auto third = person(0, 3, {});
  const auto fourth = person(other, 4, {});
  EXPECT_EQ(third->wait_for_line("met 4", kPatience), "met 4");
  EXPECT_EQ(fourth->wait_for_line("met 3", kPatience), "met 3");
  EXPECT_EQ(first->wait_for_line("met 2", seconds(1)), "");
  EXPECT_EQ(second->wait_for_line("met 1", seconds(1)), "");
}

constexpr const char* kOff = "AUTOMATIC_DISCOVERY_RANGE=OFF";
constexpr const char* kLocal = "AUTOMATIC_DISCOVERY_RANGE=LOCALHOST";
constexpr const char* kSubnet = "AUTOMATIC_DISCOVERY_RANGE=SUBNET";
constexpr const char* kSystem = "AUTOMATIC_DISCOVERY_RANGE=SYSTEM_DEFAULT";
constexpr const char* kOffAsking = "AUTOMATIC_DISCOVERY_RANGE=OFF STATIC_PEERS=@";
constexpr const char* kLocalAsking = "AUTOMATIC_DISCOVERY_RANGE=LOCALHOST STATIC_PEERS=@";
constexpr const char* kSubnetAsking = "AUTOMATIC_DISCOVERY_RANGE=SUBNET STATIC_PEERS=@";
constexpr const char* kOldLocal = "LOCALHOST_ONLY=1 DISTRO=jazzy STATIC_PEERS=@";
constexpr const char* kHumbleLocal = "LOCALHOST_ONLY=1 DISTRO=humble";

const auto kNameOf = [](const testing::TestParamInfo<Pair>& info) { return info.param.name; };

INSTANTIATE_TEST_SUITE_P(
    OnOneHost, DiscoveryRange,
    testing::Values(Pair{"OffAndOff", kOff, kOff, true, false},
                    Pair{"OffAndLocalhost", kOff, kLocal, true, false},
                    Pair{"OffAndSubnet", kOff, kSubnet, true, false},
                    Pair{"OffWithPeerAndSubnetWithPeer", kOffAsking, kSubnetAsking, true, false},
                    Pair{"LocalhostAndLocalhost", kLocal, kLocal},
                    Pair{"LocalhostAndSubnet", kLocal, kSubnet},
                    Pair{"SubnetAndLocalhost", kSubnet, kLocal},
                    Pair{"LocalhostAndSystemDefault", kLocal, kSystem},
                    Pair{"SubnetAndSystemDefault", kSubnet, kSystem},
                    Pair{"LocalhostOnlyAndSubnet", kOldLocal, kSubnet},
                    Pair{"LocalhostOnlyOfHumbleAndItself", kHumbleLocal, kHumbleLocal}),
    kNameOf);

INSTANTIATE_TEST_SUITE_P(
    OnTwoHosts, DiscoveryRange,
    testing::Values(Pair{"LocalhostAndLocalhost", kLocal, kLocal, false, false},
                    Pair{"LocalhostAndSubnet", kLocal, kSubnet, false, false},
                    Pair{"LocalhostOnlyAndItself", kOldLocal, kOldLocal, false, false},
                    Pair{"LocalhostOnlyOfHumbleAndItself", kHumbleLocal, kHumbleLocal, false,
                         false},
                    Pair{"OffWithPeerAndSubnetWithPeer", kOffAsking, kSubnetAsking, false, false},
                    Pair{"LocalhostWithPeerAndLocalhost", kLocalAsking, kLocal, false, true},
                    Pair{"LocalhostAndSubnetWithPeer", kLocal, kSubnetAsking, false, true},
                    Pair{"SubnetAndSubnet", kSubnet, kSubnet, false, true},
                    Pair{"SubnetAndSystemDefault", kSubnet, kSystem, false, true}),
    kNameOf);

/// What rmw_fastrtps of Iron and later sets for the range LOCALHOST, as a profile of Fast DDS.
constexpr const char* kProfileOfRmw = R"(<?xml version="1.0" encoding="UTF-8" ?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <transport_descriptors>
    <transport_descriptor><transport_id>shm</transport_id><type>SHM</type></transport_descriptor>
    <transport_descriptor>
      <transport_id>udp</transport_id><type>UDPv4</type>
      <maxInitialPeersRange>32</maxInitialPeersRange>
    </transport_descriptor>
  </transport_descriptors>
  <participant profile_name="localhost" is_default_profile="true">
    <rtps>
      <userTransports>
        <transport_id>shm</transport_id><transport_id>udp</transport_id>
      </userTransports>
      <useBuiltinTransports>false</useBuiltinTransports>
      <builtin>
        <metatrafficUnicastLocatorList><locator/></metatrafficUnicastLocatorList>
        <initialPeersList>
          <locator><udpv4><address>127.0.0.1</address></udpv4></locator>
        </initialPeersList>
      </builtin>
    </rtps>
  </participant>
</profiles>)";

class RmwOfLocalhost : public DiscoveryRange {
 protected:
  [[nodiscard]] auto rmw(std::size_t host, int number) const {
    const auto file = folder_.path() / "profile.xml";
    std::ofstream(file) << kProfileOfRmw;
    return peer(host, {"meet", std::to_string(number)}, "default",
                {"FASTRTPS_DEFAULT_PROFILES_FILE=" + file.string()});
  }

 private:
  TemporaryDirectory folder_;
};

TEST_P(RmwOfLocalhost, MeetsOnItsHostAndNobodyElsewhere) {
  STRATA_MAKE_HOSTS(2);
  const auto ours = person(0, 1, environment_of(GetParam().first, ""));
  const auto theirs = rmw(0, 2);
  const auto elsewhere = rmw(1, 3);
  EXPECT_EQ(ours->wait_for_line("met 2", kPatience), "met 2");
  EXPECT_EQ(theirs->wait_for_line("met 1", kPatience), "met 1");
  EXPECT_EQ(elsewhere->wait_for_line("met", seconds(1)), "");
}

INSTANTIATE_TEST_SUITE_P(With, RmwOfLocalhost,
                         testing::Values(Pair{"Localhost", kLocal, ""}, Pair{"Subnet", kSubnet, ""},
                                         Pair{"LocalhostOnly", "LOCALHOST_ONLY=1 DISTRO=jazzy",
                                              ""}),
                         kNameOf);

TEST_F(Network, ReachesAStaticPeerByItsName) {
  STRATA_MAKE_HOSTS(2);
  const TemporaryDirectory folder;
  const auto names = folder.path() / "hosts";
  std::ofstream(names) << "127.0.0.1 localhost\n" << VirtualNetwork::address(0) << " robot\n";
  network_->hub().set_multicast(false);
  const auto robot = peer(0, {"map", "10"});
  const auto asking =
      network_->run(1,
                    {"sh", "-c",
                     "mount --bind " + names.string() +
                         " /etc/hosts && exec " STRATA_NETWORK_PEER " environment get-map"},
                    {"ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST", "ROS_STATIC_PEERS=robot"});
  EXPECT_NE(asking->wait_for_line("map 10 ", kPatience), "");
}

TEST_F(Network, NamesAStaticPeerThatHasNoAddress) {
  STRATA_MAKE_HOSTS(1);
  const auto lost = network_->run(0, {STRATA_PROGRAM, "doctor"}, {"ROS_STATIC_PEERS=robot one"});
  EXPECT_NE(lost->rest().find("strata doctor: error: static peer 'robot one': has no IPv4 address"),
            std::string::npos);
  EXPECT_EQ(lost->wait(), 2);
}

}  // namespace
}  // namespace strata::test
