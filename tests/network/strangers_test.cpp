// SPDX-License-Identifier: Apache-2.0
/// Nothing that others do on the domain ends a robot: ROS 2's Cyclone processes come and go.
#include "tests/network/strangers.hpp"

#include <cstdlib>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"

namespace strata::test {
namespace {

/// Where the robot and the others are, and how it talks.
struct Place {
  std::string name;
  CycloneNetwork where;
  std::size_t networks;
  std::string transport;
};

void PrintTo(const Place& place, std::ostream* out) { *out << place.name; }

int rounds() {
  const char* given = std::getenv("STRATA_STRANGER_ROUNDS");
  return given != nullptr ? std::atoi(given) : 17;
}

class Company : public Strangers, public testing::WithParamInterface<Place> {
 protected:
  void make_place() {
    make(1, GetParam().networks);
    if (!IsSkipped() && GetParam().where == CycloneNetwork::kLoopback) {
      network_->set_up(0, "ip link set lo multicast on");
      if (GetParam().networks == 0) network_->set_up(0, "ip route add default dev lo");
    }
  }
};

// Two readers of one topic that share a multicast group aborted Fast DDS; a third node sees that
// the robot is still one of the domain.
TEST_P(Company, OfRos2NodesThatComeAndGoDoesNotEndARobot) {
  make_place();
  if (IsSkipped()) return;
  const auto robot = this->robot(0, GetParam().transport);
  for (int round = 0; round < rounds(); ++round) {
    const auto first = ros_node(0, "first", "scan_matcher", GetParam().where);
    const auto second = ros_node(0, "second", "scan_matcher", GetParam().where);
    const auto third = ros_node(0, "third", "scan_matcher", GetParam().where);
    if (round % 2 == 1) second->kill_hard();  // no goodbye
    ASSERT_TRUE(robot->runs()) << "ended in round " << round << ": " << robot->rest();
  }
  expect_good_end(*robot);
}

const auto kNameOfPlace = [](const testing::TestParamInfo<Place>& info) { return info.param.name; };

INSTANTIATE_TEST_SUITE_P(
    InEveryPlace, Company,
    testing::Values(Place{"OnLoopbackThatMulticasts", CycloneNetwork::kLoopback, 0, "default"},
                    Place{"OnOneNetwork", CycloneNetwork::kDevices, 1, "default"},
                    Place{"OnOneNetworkThatLosesFrames", CycloneNetwork::kDevices, 1, "wifi"},
                    Place{"OnTwoNetworks", CycloneNetwork::kDevices, 2, "default"},
                    Place{"OfALocalhost", CycloneNetwork::kUnicast, 1, "localhost"}),
    kNameOfPlace);

class OtherRelease : public Strangers, public testing::WithParamInterface<const char*> {};

// ROS 2 Jazzy's: their files in shared memory abort Fast DDS 2.9.
TEST_P(OtherRelease, OfFastDdsDoesNotEndARobot) {
  const char* const program = std::getenv("STRATA_OTHER_NETWORK_PEER");
  if (program == nullptr) {
    GTEST_SKIP() << "STRATA_OTHER_NETWORK_PEER names no network_peer of another release";
  }
  STRATA_MAKE_HOSTS(1, 0);
  const auto robot = this->robot(0, GetParam());
  const auto visitor = [&](std::vector<std::string> command) {
    command.insert(command.begin(), {program, "default"});
    auto process = network_->run(
        0, command,
        {"FASTRTPS_DEFAULT_PROFILES_FILE=" STRATA_SOURCE_DIR "/tests/network/ros2_fastdds.xml"});
    EXPECT_EQ(process->wait_for_line("ready", kPatience), "ready");
    return process;
  };
  for (int round = 0; round < rounds(); ++round) {
    const auto reader = visitor({"hear", "5", "tf_static"});
    const auto writer = visitor({"scans", "5", "50", "tf_static"});
    EXPECT_NE(reader->wait_for_line("heard", kPatience), "");
    if (round % 2 == 1) writer->kill_hard();  // no goodbye
    ASSERT_TRUE(robot->runs()) << "ended in round " << round << ": " << robot->rest();
  }
  expect_good_end(*robot);
}

INSTANTIATE_TEST_SUITE_P(With, OtherRelease,
                         testing::Values("default", "localhost", "wifi", "shared_memory"));

TEST_F(Strangers, OfCycloneDoNotEndARobotThatStartsLast) {
  STRATA_MAKE_HOSTS(1);
  const auto first = cyclone(0, {"ros_node", "/", "first"});
  const auto second = cyclone(0, {"ros_node", "/", "second"});
  for (int round = 0; round < rounds(); ++round) {
    const auto robot = this->robot(0, "default");
    ASSERT_NE(second->wait_for_line("node / scan_matcher", kPatience), "");
    expect_good_end(*robot);
  }
}

TEST_F(Strangers, OfCycloneDoNotEndARobotAtADiscoveryServer) {
  STRATA_MAKE_HOSTS(1);
  const auto server = network_->run(
      0, {"fastdds", "discovery", "-i", "0", "-l", VirtualNetwork::address(0), "-p", "11811"});
  ASSERT_NE(server->wait_for_line("### Server is running ###"), "");
  const auto robot = this->robot(0, "discovery_server",
                                 {"ROS_DISCOVERY_SERVER=" + VirtualNetwork::address(0) + ":11811"});
  // Nobody is told of them, but their announcements reach every socket of the domain.
  expect_to_outlive_visits(*robot, rounds());
}

TEST_F(Strangers, OfCycloneDoNotEndARobotWithDdsSecurity) {
  STRATA_MAKE_HOSTS(1);
  const TemporaryDirectory folder;
  const std::string keystore = (folder.path() / "keystore").string();
  network_->set_up(0, std::string(STRATA_PROGRAM) + " keystore create " + keystore + " && " +
                          STRATA_PROGRAM + " keystore add " + keystore + " /robot");
  const auto robot =
      this->robot(0, "default",
                  {"ROS_SECURITY_ENABLE=true", "ROS_SECURITY_STRATEGY=Enforce",
                   "ROS_SECURITY_KEYSTORE=" + keystore, "ROS_SECURITY_ENCLAVE_OVERRIDE=/robot"});
  expect_to_outlive_visits(*robot, rounds());
}

}  // namespace
}  // namespace strata::test
