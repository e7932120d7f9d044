// SPDX-License-Identifier: Apache-2.0
/// `strata run` as a service manager sees it.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/service_manager.hpp"

namespace strata::test {

/// Compositions with components of the library `gate`, in a folder of the test's own.
class ManagedRun : public testing::Test {
 protected:
  static constexpr auto kPatience = std::chrono::seconds(60);
  static constexpr const char* kActiveAtOnce =
      "  - name: first\n    components: [{type: strata::BeamFilter, name: filter}]\n";

  [[nodiscard]] std::filesystem::path at(const char* name) const { return folder_.path() / name; }
  /// The components of a process: one of the library. parameters: besides its folder.
  [[nodiscard]] std::string component(const char* type, const std::string& parameters = "",
                                      const std::string& name = "gate") const {
    return std::string("    components: [{type: gate::") + type + ", name: " + name +
           ", parameters: {folder: '" + folder_.path().string() + "'" + parameters + "}}]\n";
  }
  /// processes: YAML lines, indented.
  [[nodiscard]] std::unique_ptr<ChildProcess> run(const std::string& processes) const {
    std::ofstream(at("c.yaml")) << "version: 1\ntransport: loopback\nlibraries: [" STRATA_TEST_GATE
                                   "]\nprocesses:\n"
                                << processes;
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{STRATA_PROGRAM, "run", at("c.yaml").string(), "--set",
                                 "domain=" + std::to_string(own_domain())},
        std::vector<std::string>{"NOTIFY_SOCKET=" + at("notify").string()},
        ChildProcess::Errors::kMerged);
  }
  [[nodiscard]] bool appears(const char* name) const {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!std::filesystem::exists(at(name))) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  const TemporaryDirectory folder_;
  ServiceManager manager_{at("notify").string()};
};

}  // namespace strata::test
