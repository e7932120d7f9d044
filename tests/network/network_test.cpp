// SPDX-License-Identifier: Apache-2.0
/// Two and three hosts that see each other through a network only, good or bad.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/network/virtual_network.hpp"

namespace strata::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

constexpr auto kPatience = seconds(60);

class Network : public testing::Test {
 protected:
  /// Skips the test where hosts cannot be made.
  void make(std::size_t hosts) {
    try {
      network_ = std::make_unique<VirtualNetwork>(hosts);
    } catch (const OutputError& error) {
      GTEST_SKIP() << error.what();
    }
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> peer(std::size_t host,
                                                   const std::vector<std::string>& arguments,
                                                   const std::string& transport = "default") const {
    std::vector<std::string> command = {STRATA_NETWORK_PEER, transport};
    command.insert(command.end(), arguments.begin(), arguments.end());
    auto process = network_->run(host, command);
    EXPECT_EQ(process->wait_for_line("ready"), "ready");
    return process;
  }
  [[nodiscard]] std::string doctor(std::size_t host, const std::string& transport) const {
    return network_
        ->run(host, {STRATA_PROGRAM, "doctor", "--seconds", "4", "--transport", transport})
        ->rest();
  }

  std::unique_ptr<VirtualNetwork> network_;
};

#define STRATA_MAKE_HOSTS(hosts) \
  make(hosts);                   \
  if (IsSkipped()) return

TEST_F(Network, ShowsNodesOfEveryHostToEveryOther) {
  STRATA_MAKE_HOSTS(3);
  const auto first = peer(0, {"map", "10"});
  const auto second = peer(1, {"get-map"});
  EXPECT_THAT(doctor(2, "default"), HasSubstr("2 participants"));
  EXPECT_NE(second->wait_for_line("map 10 ", kPatience), "");
}

TEST_F(Network, KeepsLoopbackToItsHost) {
  STRATA_MAKE_HOSTS(2);
  const auto there = peer(0, {"map", "10"}, "loopback");
  const auto here = peer(0, {"get-map"}, "loopback");
  const auto elsewhere = peer(1, {"get-map"}, "loopback");
  EXPECT_NE(here->wait_for_line("map 10 ", kPatience), "");
  EXPECT_EQ(elsewhere->wait_for_line("map", seconds(1)), "");
}

TEST_F(Network, GivesALateJoinerEveryLatchedMap) {
  STRATA_MAKE_HOSTS(2);
  const auto server = peer(0, {"map", "2000"});  // 4 MB
  const auto first = peer(1, {"get-map"});
  const std::string map = first->wait_for_line("map", kPatience);
  EXPECT_THAT(map, HasSubstr("map 2000 "));
  const auto late = peer(1, {"get-map"});
  EXPECT_EQ(late->wait_for_line("map", kPatience), map);
}

TEST_F(Network, LosesNoReliableMessageThoughItLosesATenthOfAllFrames) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set({0.1, milliseconds(50)});
  const auto listener = peer(1, {"hear", "100"}, "wifi");
  const auto talker = peer(0, {"scans", "100", "10"}, "wifi");
  EXPECT_EQ(listener->wait_for_line("heard", kPatience), "heard 100 of 100, 100 in order");
  EXPECT_GT(network_->hub().lost(), 50U);
}

TEST_F(Network, BringsALargeMapThoughItLosesATenthOfAllFrames) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set({0.1, milliseconds(50)});
  const auto server = peer(0, {"map", "2000"}, "wifi");
  const auto client = peer(1, {"get-map"}, "wifi");
  EXPECT_THAT(client->wait_for_line("map", kPatience), HasSubstr("map 2000 "));
  EXPECT_GT(network_->hub().lost(), 200U);
}

TEST_F(Network, FindsARobotAgainThatReboots) {
  STRATA_MAKE_HOSTS(2);
  const auto client = peer(1, {"get-map"});
  auto robot = peer(0, {"map", "10"});
  EXPECT_THAT(client->wait_for_line("map", kPatience), HasSubstr("map 10 "));
  for (const char* cells : {"11", "12"}) {
    robot->kill_hard();  // no goodbye
    robot = peer(0, {"map", cells});
    EXPECT_THAT(client->wait_for_line("map", seconds(5)), HasSubstr(std::string("map ") + cells));
  }
}

TEST_F(Network, FindsARobotAgainWhoseLinkWasDown) {
  STRATA_MAKE_HOSTS(2);
  const auto client = peer(1, {"get-map"});
  const auto robot = peer(0, {"map", "10"});
  EXPECT_NE(client->wait_for_line("map", kPatience), "");
  network_->hub().set({1.0, milliseconds(0)});
  const auto silent = peer(0, {"map", "11"});
  EXPECT_EQ(client->wait_for_line("map", seconds(1)), "");
  network_->hub().set({0.0, milliseconds(0)});
  EXPECT_THAT(client->wait_for_line("map", kPatience), HasSubstr("map 11 "));
}

TEST_F(Network, MeetsAtADiscoveryServer) {
  STRATA_MAKE_HOSTS(3);
  const std::string where = "ROS_DISCOVERY_SERVER=" + VirtualNetwork::address(0) + ":11811";
  const auto server = network_->run(
      0, {"fastdds", "discovery", "-i", "0", "-l", VirtualNetwork::address(0), "-p", "11811"});
  ASSERT_NE(server->wait_for_line("### Server is running ###"), "");
  const auto start = [&](std::size_t host, const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {STRATA_NETWORK_PEER, "discovery_server"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return network_->run(host, command, {where});
  };
  const auto talker = start(1, {"map", "10"});
  const auto listener = start(2, {"get-map"});
  EXPECT_THAT(listener->wait_for_line("map", kPatience), HasSubstr("map 10 "));
  // Whoever does not ask the server does not see them.
  const auto stranger = peer(2, {"get-map"});
  EXPECT_EQ(stranger->wait_for_line("map", seconds(1)), "");
}

TEST_F(Network, ReachesAStaticPeerWithoutMulticast) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set_multicast(false);
  const auto robot = peer(0, {"map", "10"});
  const auto alone = peer(1, {"get-map"});
  EXPECT_EQ(alone->wait_for_line("map", seconds(1)), "");
  const auto asking = network_->run(1, {STRATA_NETWORK_PEER, "default", "get-map"},
                                    {"ROS_STATIC_PEERS=" + VirtualNetwork::address(0)});
  EXPECT_THAT(asking->wait_for_line("map", kPatience), HasSubstr("map 10 "));
}

}  // namespace
}  // namespace strata::test
