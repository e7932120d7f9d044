// SPDX-License-Identifier: Apache-2.0
/// Tests on hosts of their own; skipped where those cannot be made.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/network/virtual_network.hpp"

namespace strata::test {

class Network : public testing::Test {
 protected:
  static constexpr auto kPatience = std::chrono::seconds(60);

  /// Skips the test where hosts cannot be made.
  void make(std::size_t hosts, std::size_t networks = 1) {
    try {
      network_ = std::make_unique<VirtualNetwork>(hosts, networks);
    } catch (const OutputError& error) {
      GTEST_SKIP() << error.what();
    }
  }
  /// A network_peer that is ready. transport: "environment" for what the variables say.
  [[nodiscard]] std::unique_ptr<ChildProcess> peer(
      std::size_t host, const std::vector<std::string>& arguments,
      const std::string& transport = "default", std::vector<std::string> environment = {}) const {
    std::vector<std::string> command = {STRATA_NETWORK_PEER, transport};
    command.insert(command.end(), arguments.begin(), arguments.end());
    auto process = network_->run(host, command, std::move(environment));
    EXPECT_EQ(process->wait_for_line("ready"), "ready");
    return process;
  }
  [[nodiscard]] std::string doctor(std::size_t host) const {
    return network_->run(host, {STRATA_PROGRAM, "doctor", "--seconds", "5"})->rest();
  }

  std::unique_ptr<VirtualNetwork> network_;
};

#define STRATA_MAKE_HOSTS(...) \
  make(__VA_ARGS__);           \
  if (IsSkipped()) return

}  // namespace strata::test
