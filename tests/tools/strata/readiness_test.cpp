// SPDX-License-Identifier: Apache-2.0
/// What `strata run` tells systemd, and when.
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <signal.h>

#include "tests/tools/strata/managed_run.hpp"

namespace strata::tools {
namespace {

class Readiness : public test::ManagedRun {
 protected:
  void open_gate() const { std::ofstream(at("open")).close(); }
  /// Ends it as systemd does.
  void expect_good_end(test::ChildProcess& process) {
    process.send(SIGINT);
    EXPECT_EQ(manager_.receive(kPatience), "STOPPING=1");
    EXPECT_EQ(process.wait(), 0);
    EXPECT_EQ(manager_.receive(), "") << "nothing is told twice";
  }
  void expect_ready_behind_the_gate(test::ChildProcess& process) {
    ASSERT_TRUE(appears("waiting"));
    EXPECT_EQ(manager_.receive(), "") << "it is not active yet";
    open_gate();
    EXPECT_EQ(manager_.receive(kPatience), "READY=1");
    expect_good_end(process);
  }
};

TEST_F(Readiness, OfSeveralProcessesIsToldWhenTheLastIsActive) {
  const auto process = run(kActiveAtOnce + ("  - name: second\n" + component("Gate")));
  ASSERT_NE(process->wait_for_line("process first runs", kPatience), "");
  expect_ready_behind_the_gate(*process);
}

TEST_F(Readiness, OfOneProcessThatMayRestartIsToldWhenItIsActive) {
  const auto process = run("  - name: only\n    restart: on_failure\n" + component("Gate"));
  expect_ready_behind_the_gate(*process);
}

TEST_F(Readiness, OfOneProcessIsToldWhenItIsActive) {
  const auto process = run("  - name: only\n" + component("Gate"));
  expect_ready_behind_the_gate(*process);
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
          component("Gate"));
  ASSERT_EQ(manager_.receive(kPatience), "READY=1");
  const pid_t first = process->child_with("first");
  ASSERT_NE(first, 0);
  kill(first, SIGKILL);
  ASSERT_NE(process->wait_for_line("process first has ended", kPatience), "");
  ASSERT_NE(process->wait_for_line("process first runs", kPatience), "");
  expect_good_end(*process);
}

}  // namespace
}  // namespace strata::tools
