// SPDX-License-Identifier: Apache-2.0
/// Two and three hosts that see each other through a network only, good or bad.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/bag.hpp"
#include "tests/network/network_fixture.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

TEST_F(Network, ShowsNodesOfEveryHostToEveryOther) {
  STRATA_MAKE_HOSTS(3);
  const auto first = peer(0, {"map", "10"});
  const auto second = peer(1, {"get-map"});
  const std::string report = doctor(2);
  EXPECT_THAT(report, HasSubstr("2 participants"));
  EXPECT_THAT(report, Not(HasSubstr("transport: wifi")));
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

// With the default transport a scan of 1,080 beams is a datagram of three frames, lost with any of
// them; its topic keeps every message, so that each may be asked for as often as it takes.
TEST_F(Network, LosesNoReliableMessageOnTheDefaultTransportEither) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set({0.1, milliseconds(50)});
  const auto listener = peer(1, {"hear", "100", "lossless"});
  const auto talker = peer(0, {"scans", "100", "10", "lossless"});
  EXPECT_EQ(listener->wait_for_line("heard", kPatience), "heard 100 of 100, 100 in order");
  EXPECT_GT(network_->hub().lost(), 50U);
}

// A writer that keeps its last 10 messages has forgotten the first where its reader meets it more
// than a second after it met its reader, as on such a network may be; so both have met before.
TEST_F(Network, LosesNoReliableMessageThoughItLosesATenthOfAllFrames) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set({0.1, milliseconds(50)});
  const auto listener = peer(1, {"hear", "100"}, "wifi");
  const auto talker = peer(0, {"scans", "100", "10", "default", "told"}, "wifi");
  ASSERT_EQ(listener->wait_for_line("met", kPatience), "met");
  talker->tell("go");
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

TEST_F(Network, LetsTheDoctorAdviseSmallDatagramsForAMapThatDoesNotArrive) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set({0.1, milliseconds(50)});
  const auto server = peer(0, {"map", "2000"});
  const std::string report = doctor(1);
  EXPECT_THAT(report, ContainsRegex("note: /map: is latched .*nothing of it has come"));
  EXPECT_THAT(report, HasSubstr("transport: wifi"));
}

TEST_F(Network, LetsTheDoctorCountScansThatWereLost) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set({0.1, milliseconds(50)});
  const auto listener = peer(1, {"hear", "10", "lossless"});
  const auto talker = peer(0, {"scans", "1000", "20", "lossless"});
  ASSERT_NE(listener->wait_for_line("heard", kPatience), "");  // so they flow
  const std::string report = doctor(1);
  EXPECT_THAT(report, ContainsRegex("note: /scan: [0-9]+ of [0-9]+ messages"));
  EXPECT_THAT(report, HasSubstr("transport: wifi"));
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

class NetworkWithAServer : public Network {
 protected:
  /// Three hosts, and a server on the first.
  void make_server() {
    make(3);
    if (IsSkipped()) return;
    server_ = network_->run(
        0, {"fastdds", "discovery", "-i", "0", "-l", VirtualNetwork::address(0), "-p", "11811"});
    ASSERT_NE(server_->wait_for_line("### Server is running ###"), "");
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> start(std::size_t host,
                                                    const std::vector<std::string>& command) const {
    return network_->run(host, command,
                         {"ROS_DISCOVERY_SERVER=" + VirtualNetwork::address(0) + ":11811"});
  }

  std::unique_ptr<ChildProcess> server_;
};

TEST_F(NetworkWithAServer, MeetsThere) {
  make_server();
  if (IsSkipped()) return;
  const auto talker = start(1, {STRATA_NETWORK_PEER, "discovery_server", "map", "10"});
  const auto listener = start(2, {STRATA_NETWORK_PEER, "discovery_server", "get-map"});
  EXPECT_THAT(listener->wait_for_line("map", kPatience), HasSubstr("map 10 "));
  // Whoever does not ask the server does not see them.
  const auto stranger = peer(2, {"get-map"});
  EXPECT_EQ(stranger->wait_for_line("map", seconds(1)), "");
}

TEST_F(NetworkWithAServer, FindsTopicsThatItHasNoPartIn) {
  make_server();
  if (IsSkipped()) return;
  const TemporaryDirectory folder;
  const fs::path bag = folder.path() / "bag";
  const auto talker = start(1, {STRATA_NETWORK_PEER, "discovery_server", "map", "10"});
  const auto recorder =
      start(2, {STRATA_PROGRAM, "record", "--out", bag.string(), "--topics", "/map"});
  ASSERT_NE(recorder->wait_for_line("recording into", kPatience), "");
  const auto recorded = [&] {
    const auto reader = log::BagReader::open(bag);
    log::BagMessage message;
    return reader->next(message);
  };
  EXPECT_TRUE(comes_true(recorded));
  recorder->send(SIGINT);
  EXPECT_EQ(recorder->wait(), 0) << recorder->rest();
  EXPECT_THAT(start(2, {STRATA_PROGRAM, "doctor", "--json", "--seconds", "5"})->rest(),
              HasSubstr("\"/map\""));
}

TEST_F(Network, ReachesAStaticPeerWithoutMulticast) {
  STRATA_MAKE_HOSTS(2);
  network_->hub().set_multicast(false);
  const auto robot = peer(0, {"map", "10"});
  const auto alone = peer(1, {"get-map"});
  EXPECT_EQ(alone->wait_for_line("map", seconds(1)), "");
  const auto asking =
      peer(1, {"get-map"}, "default", {"ROS_STATIC_PEERS=" + VirtualNetwork::address(0)});
  EXPECT_THAT(asking->wait_for_line("map", kPatience), HasSubstr("map 10 "));
  // Its main use: with the range LOCALHOST, to which the robot on another host is nobody else's.
  const auto local = peer(1, {"get-map"}, "environment",
                          {"ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST",
                           "ROS_STATIC_PEERS=" + VirtualNetwork::address(0)});
  EXPECT_THAT(local->wait_for_line("map", kPatience), HasSubstr("map 10 "));
}

}  // namespace
}  // namespace strata::test
