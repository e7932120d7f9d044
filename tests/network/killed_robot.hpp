// SPDX-License-Identifier: Apache-2.0
/// What tests share that kill a robot's process on its host, while its sensors live on another.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <signal.h>

#include "core/base/error.hpp"
#include "tests/network/virtual_network.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {

class KilledRobot : public testing::Test {
 protected:
  void SetUp() override {
    try {
      network_ = std::make_unique<VirtualNetwork>(2);
    } catch (const OutputError& error) {
      GTEST_SKIP() << error.what();
    }
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> run(std::size_t host,
                                                  const std::string& composition) const {
    return network_->run(host, {STRATA_PROGRAM, "run", "--quiet", at(composition).string()});
  }
  /// Kills the robot's only process and waits for the next.
  static void kill_and_wait(const ChildProcess& robot) {
    const std::set<pid_t> processes = robot.children();
    ASSERT_EQ(processes.size(), 1U);
    kill(*processes.begin(), SIGKILL);
    ASSERT_TRUE(comes_true([&] {
      const std::set<pid_t> now = robot.children();
      return now.size() == 1 && now != processes;
    }));
  }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const {
    return folder_.path() / name;
  }

  TemporaryDirectory folder_;
  std::unique_ptr<VirtualNetwork> network_;
};

}  // namespace strata::test
