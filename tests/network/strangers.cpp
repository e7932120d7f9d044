// SPDX-License-Identifier: Apache-2.0
#include "tests/network/strangers.hpp"

#include <csignal>
#include <utility>

namespace strata::test {

std::unique_ptr<ChildProcess> Strangers::cyclone(std::size_t host,
                                                 const std::vector<std::string>& arguments,
                                                 CycloneNetwork where,
                                                 const std::vector<std::string>& devices) const {
  std::vector<std::string> command = {STRATA_CYCLONE_PEER, "0"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  auto process = network_->run(host, command, {cyclone_configuration(where, devices)});
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

void Strangers::expect_to_outlive_visits(ChildProcess& robot, int rounds) const {
  for (int round = 0; round < rounds; ++round) {
    const auto first = cyclone(0, {"ros_node", "/", "first"});
    const auto second = cyclone(0, {"ros_node", "/", "second"});
    ASSERT_NE(second->wait_for_line("node / first", kPatience), "");
    ASSERT_TRUE(robot.runs()) << robot.rest();
  }
  expect_good_end(robot);
}

void Strangers::expect_good_end(ChildProcess& process) {
  EXPECT_TRUE(process.runs());
  process.send(SIGINT);
  const std::string said = process.rest();
  EXPECT_EQ(process.wait(), 0) << said;
}

}  // namespace strata::test
