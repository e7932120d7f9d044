// SPDX-License-Identifier: Apache-2.0
#include "tests/network/strangers.hpp"

#include <csignal>
#include <utility>

namespace strata::test {
namespace {

std::string configuration(CycloneNetwork where, const std::vector<std::string>& devices) {
  std::string general;
  std::string discovery;
  if (where == CycloneNetwork::kUnicast) {
    general = "<AllowMulticast>false</AllowMulticast>";
    discovery =
        "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
        "<Peers><Peer address=\"localhost\"/></Peers>";
  } else {
    for (const std::string& device : devices) {
      general += "<NetworkInterface name=\"" + device + "\"" +
                 (device == "lo" ? " multicast=\"true\"" : "") + "/>";
    }
    general = "<Interfaces>" + general + "</Interfaces>";
  }
  return "CYCLONEDDS_URI=<CycloneDDS><Domain><General>" + general +
         "</General><Discovery><ParticipantIndex>auto</ParticipantIndex>" + discovery +
         "</Discovery></Domain></CycloneDDS>";
}

}  // namespace

std::unique_ptr<ChildProcess> Strangers::cyclone(std::size_t host,
                                                 const std::vector<std::string>& arguments,
                                                 CycloneNetwork where,
                                                 const std::vector<std::string>& devices) const {
  std::vector<std::string> command = {STRATA_CYCLONE_PEER, "0"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  auto process = network_->run(
      host, command,
      {configuration(
          where, where == CycloneNetwork::kLoopback ? std::vector<std::string>{"lo"} : devices)});
  EXPECT_EQ(process->wait_for_line("ready", kPatience), "ready");
  return process;
}

std::unique_ptr<ChildProcess> Strangers::ros_node(std::size_t host, const std::string& name,
                                                  const std::string& other,
                                                  CycloneNetwork where) const {
  auto node = cyclone(host, {"ros_node", "/", name}, where);
  EXPECT_NE(node->wait_for_line("node / " + other, kPatience), "") << name;
  return node;
}

std::unique_ptr<ChildProcess> Strangers::robot(std::size_t host, const std::string& transport,
                                               std::vector<std::string> environment) const {
  std::vector<std::string> command = {STRATA_PROGRAM, "run",
                                      STRATA_SOURCE_DIR "/components/config/mapping.yaml", "--set",
                                      "transport=" + transport};
  auto process = network_->run(host, command, std::move(environment));
  EXPECT_NE(process->wait_for_line("process mapping runs", kPatience), "");
  return process;
}

void Strangers::expect_good_end(ChildProcess& process) {
  EXPECT_TRUE(process.runs());
  process.send(SIGINT);
  const std::string said = process.rest();
  EXPECT_EQ(process.wait(), 0) << said;
}

}  // namespace strata::test
