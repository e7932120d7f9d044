// SPDX-License-Identifier: Apache-2.0
/// What `strata run` tells systemd, and when.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>

#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/service_manager.hpp"

namespace strata::tools {
namespace {

constexpr auto kPatience = std::chrono::seconds(60);

class Readiness : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path at(const char* name) const { return folder_.path() / name; }
  [[nodiscard]] std::string gate() const {
    return "    components: [{type: gate::Gate, name: gate, parameters: {folder: '" +
           folder_.path().string() + "'}}]\n";
  }
  /// processes: YAML lines, indented.
  [[nodiscard]] std::unique_ptr<test::ChildProcess> run(const std::string& processes) const {
    std::ofstream(at("c.yaml")) << "version: 1\ntransport: loopback\nlibraries: [" STRATA_TEST_GATE
                                   "]\nprocesses:\n"
                                << processes;
    return std::make_unique<test::ChildProcess>(
        std::vector<std::string>{STRATA_PROGRAM, "run", at("c.yaml").string(), "--set",
                                 "domain=" + std::to_string(test::own_domain())},
        std::vector<std::string>{"NOTIFY_SOCKET=" + at("notify").string()},
        test::ChildProcess::Errors::kMerged);
  }
  [[nodiscard]] bool appears(const char* name) const {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!std::filesystem::exists(at(name))) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }
  void open_gate() const { std::ofstream(at("open")).close(); }
  /// Ends it as systemd does.
  void expect_good_end(test::ChildProcess& process) {
    process.send(SIGINT);
    EXPECT_EQ(manager_.receive(kPatience), "STOPPING=1");
    EXPECT_EQ(process.wait(), 0);
    EXPECT_EQ(manager_.receive(), "") << "nothing is told twice";
  }

  const test::TemporaryDirectory folder_;
  test::ServiceManager manager_{at("notify").string()};
};

constexpr const char* kActiveAtOnce =
    "  - name: first\n    components: [{type: strata::BeamFilter, name: filter}]\n";

TEST_F(Readiness, OfSeveralProcessesIsToldWhenTheLastIsActive) {
  const auto process = run(kActiveAtOnce + ("  - name: second\n" + gate()));
  ASSERT_NE(process->wait_for_line("process first runs", kPatience), "");
  ASSERT_TRUE(appears("waiting"));
  EXPECT_EQ(manager_.receive(), "") << "the second is not active yet";
  open_gate();
  EXPECT_EQ(manager_.receive(kPatience), "READY=1");
  expect_good_end(*process);
}

TEST_F(Readiness, OfOneProcessThatMayRestartIsToldWhenItIsActive) {
  const auto process = run("  - name: only\n    restart: on_failure\n" + gate());
  ASSERT_TRUE(appears("waiting"));
  EXPECT_EQ(manager_.receive(), "");
  open_gate();
  EXPECT_EQ(manager_.receive(kPatience), "READY=1");
  expect_good_end(*process);
}

TEST_F(Readiness, OfOneProcessIsToldWhenItIsActive) {
  const auto process = run("  - name: only\n" + gate());
  ASSERT_TRUE(appears("waiting"));
  EXPECT_EQ(manager_.receive(), "");
  open_gate();
  EXPECT_EQ(manager_.receive(kPatience), "READY=1");
  expect_good_end(*process);
}

TEST_F(Readiness, IsNotToldOfACompositionInWhichAProcessCannotStart) {
  const auto process =
      run(kActiveAtOnce + std::string("  - name: second\n    components:\n"
                                      "      - {type: strata::Localizer, name: localizer, "
                                      "parameters: {maps: /no/such/maps}}\n"));
  const std::string said = process->rest();
  EXPECT_EQ(process->wait(), 1) << said;
  EXPECT_NE(said.find("/no/such/maps"), std::string::npos) << said;
  EXPECT_EQ(manager_.receive(), "") << "neither READY=1 nor anything else";
}

TEST_F(Readiness, IsToldOnceThoughAProcessStartsAgain) {
  open_gate();
  const auto process =
      run("  - name: first\n    restart: on_failure\n    restart_delay_s: 0\n"
          "    components: [{type: strata::BeamFilter, name: filter}]\n"
          "  - name: second\n" +
          gate());
  ASSERT_EQ(manager_.receive(kPatience), "READY=1");
  const auto children = process->children();
  ASSERT_EQ(children.size(), 2U);
  kill(*children.begin(), SIGKILL);
  ASSERT_NE(process->wait_for_line("process first has ended", kPatience), "");
  ASSERT_NE(process->wait_for_line("process first runs", kPatience), "");
  expect_good_end(*process);
}

}  // namespace
}  // namespace strata::tools
