// SPDX-License-Identifier: Apache-2.0
/// Every transport of ours with every peer on every network: the table in docs/networks.md. Each
/// cell sends scans both ways and prints what was sent and what came.
///
/// The peer of another release of Fast DDS is network_peer built with that release, and is left out
/// where STRATA_OTHER_NETWORK_PEER does not name it.
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/network/strangers.hpp"

namespace strata::test {
namespace {

using std::chrono::seconds;

constexpr const char* kScans = "100";
constexpr const char* kHertz = "50";

enum class Peer { kStrata, kFastDds, kOtherFastDds, kCyclone };

struct MatrixCell {
  Peer peer;
  std::size_t networks;  ///< 0: both on one host that has lo only; else two hosts
  std::string transport;
  [[nodiscard]] std::size_t hosts() const { return networks == 0 ? 1 : 2; }
  /// localhost keeps to its host, and our shared memory to ourselves.
  [[nodiscard]] bool meets() const {
    if (transport == "shared_memory") return networks == 0 && peer == Peer::kStrata;
    return networks == 0 || transport != "localhost";
  }
};

std::string peer_name(Peer peer) {
  switch (peer) {
    case Peer::kStrata:
      return "Strata";
    case Peer::kFastDds:
      return "Fast DDS";
    case Peer::kOtherFastDds:
      return "other Fast DDS";
    case Peer::kCyclone:
      break;
  }
  return "Cyclone DDS";
}

std::string network_name(std::size_t networks) {
  return networks == 0 ? "lo" : networks == 1 ? "one network" : "two networks";
}

void PrintTo(const MatrixCell& cell, std::ostream* out) {
  *out << peer_name(cell.peer) << ", " << network_name(cell.networks) << ", " << cell.transport;
}

class Matrix : public Strangers, public testing::WithParamInterface<MatrixCell> {
 protected:
  /// Arguments as of network_peer, which cyclone_peer shares.
  [[nodiscard]] std::unique_ptr<ChildProcess> other(std::vector<std::string> arguments) const {
    const MatrixCell& cell = GetParam();
    const std::size_t host = cell.hosts() - 1;
    if (cell.peer == Peer::kCyclone) {
      const auto where = cell.networks == 0 ? CycloneNetwork::kUnicast : CycloneNetwork::kDevices;
      arguments.pop_back();  // the profile
      return cyclone(host, arguments, where,
                     cell.networks == 2 ? std::vector<std::string>{"eth0", "eth1"}
                                        : std::vector<std::string>{"eth0"});
    }
    if (cell.peer == Peer::kStrata) return peer(host, arguments, cell.transport);
    const char* program = cell.peer == Peer::kFastDds ? STRATA_NETWORK_PEER
                                                      : std::getenv("STRATA_OTHER_NETWORK_PEER");
    arguments.insert(arguments.begin(), {program, "default"});
    auto process = network_->run(
        host, arguments,
        {"FASTRTPS_DEFAULT_PROFILES_FILE=" STRATA_SOURCE_DIR "/tests/network/ros2_fastdds.xml"});
    EXPECT_EQ(process->wait_for_line("ready"), "ready");
    return process;
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> ours(
      const std::vector<std::string>& arguments) const {
    return peer(0, arguments, GetParam().transport);
  }
  /// Where nothing is to come: two who may meet, who came later, have met; so all could have.
  void let_others_meet() const {
    const auto first = peer(0, {"meet", "1"});
    const auto second = peer(GetParam().hosts() - 1, {"meet", "2"});
    EXPECT_EQ(first->wait_for_line("met", kPatience), "met 2");
    EXPECT_EQ(second->wait_for_line("met", kPatience), "met 1");
  }
  /// What the reader says of the scans; "0 of 100" where nothing came.
  [[nodiscard]] std::string exchange(ChildProcess& writer, ChildProcess& reader) const {
    if (!GetParam().meets()) {
      let_others_meet();
      EXPECT_EQ(reader.wait_for_line("heard", seconds(1)), "");
      EXPECT_EQ(writer.wait_for_line("done", seconds(1)), "");
    }
    const std::string heard =
        GetParam().meets() ? reader.wait_for_line("heard", kPatience) : std::string();
    for (ChildProcess* process : {&writer, &reader}) {
      EXPECT_TRUE(process->runs());
      if (!GetParam().meets()) {
        process->kill_hard();  // the writer still waits for a reader
        continue;
      }
      process->close_input();
      EXPECT_EQ(process->wait(), 0);
    }
    return heard.empty() ? "0 of " + std::string(kScans) : heard.substr(6);
  }
};

TEST_P(Matrix, BringsEveryScanToWhomItMeets) {
  const MatrixCell& cell = GetParam();
  if (cell.peer == Peer::kOtherFastDds && std::getenv("STRATA_OTHER_NETWORK_PEER") == nullptr) {
    GTEST_SKIP() << "STRATA_OTHER_NETWORK_PEER names no network_peer of another release";
  }
  STRATA_MAKE_HOSTS(cell.hosts(), cell.networks);
  const auto reader = ours({"hear", kScans, "lossless"});
  const auto their_writer = other({"scans", kScans, kHertz, "lossless"});
  const std::string to_us = exchange(*their_writer, *reader);
  // Latched, since Cyclone may listen later than it says; 100 of them.
  const auto their_reader = other({"hear", kScans, "tf_static"});
  const auto writer = ours({"scans", kScans, kHertz, "tf_static"});
  const std::string from_us = exchange(*writer, *their_reader);
  std::cout << "| " << peer_name(cell.peer) << " | " << network_name(cell.networks) << " | "
            << cell.transport << " | " << to_us << " | " << from_us << " |\n";
  const std::string all = std::string(kScans) + " of " + kScans + ", " + kScans + " in order";
  EXPECT_EQ(to_us, cell.meets() ? all : "0 of " + std::string(kScans));
  EXPECT_EQ(from_us, cell.meets() ? all : "0 of " + std::string(kScans));
}

std::vector<MatrixCell> cells() {
  std::vector<MatrixCell> result;
  for (const Peer peer : {Peer::kStrata, Peer::kFastDds, Peer::kOtherFastDds, Peer::kCyclone}) {
    for (const std::size_t networks : {0U, 1U, 2U}) {
      for (const char* transport : {"default", "localhost", "shared_memory", "wifi"}) {
        result.push_back({peer, networks, transport});
      }
    }
  }
  return result;
}

const auto kNameOf = [](const testing::TestParamInfo<MatrixCell>& info) {
  std::string name;
  for (const char c : testing::PrintToString(info.param)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
    if (c == ',') name += '_';
  }
  return name;
};

INSTANTIATE_TEST_SUITE_P(Cells, Matrix, testing::ValuesIn(cells()), kNameOf);

}  // namespace
}  // namespace strata::test
