// SPDX-License-Identifier: Apache-2.0
/// How `strata run` ends: what takes its time to write is waited for, and systemd is told.
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "tests/tools/strata/managed_run.hpp"

namespace strata::tools {
namespace {

/// Longer than programs that write nothing are given, far shorter than kStopPatience.
constexpr const char* kSlow = ", takes_s: 3";
constexpr const char* kEndless = ", takes_s: 10000";

class Stopping : public test::ManagedRun {
 protected:
  [[nodiscard]] std::string in_one_process(const char* takes) const {
    return "  - name: only\n" + component("SlowStore", takes);
  }
  [[nodiscard]] std::string in_several(const char* takes) const {
    return kActiveAtOnce + ("  - name: slow\n" + component("SlowStore", takes));
  }
  void expect_all_kept(const std::string& processes) {
    const auto process = run(processes);
    ASSERT_EQ(manager_.receive(kPatience), "READY=1");
    // As `timeout` and launchers do, which signal the process and its group.
    process->send(SIGINT);
    process->send(SIGINT);
    EXPECT_EQ(process->wait(), 0) << process->rest();
    EXPECT_TRUE(std::filesystem::exists(at("kept")));
  }
  /// Signals again and again until all processes are gone; what they said.
  [[nodiscard]] std::string said_when_hurried(const std::string& processes) {
    const auto process = run(processes);
    EXPECT_EQ(manager_.receive(kPatience), "READY=1");
    const std::set<pid_t> children = process->children();
    process->send(SIGTERM);
    EXPECT_TRUE(appears("begun"));
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (process->runs() && std::chrono::steady_clock::now() < deadline) {
      process->send(SIGTERM);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_EQ(process->wait(), 1);
    for (const pid_t child : children) EXPECT_NE(kill(child, 0), 0) << "one is left";
    EXPECT_FALSE(std::filesystem::exists(at("kept")));
    return process->rest();
  }
};

TEST_F(Stopping, OfOneProcessWaitsForAStoreThatIsSlowToWrite) {
  expect_all_kept(in_one_process(kSlow));
}

TEST_F(Stopping, IsNotHurriedByALauncherThatSendsAnotherSignal) {
  const auto process = run(in_one_process(kSlow));
  ASSERT_EQ(manager_.receive(kPatience), "READY=1");
  process->send(SIGINT);
  while (process->runs()) {  // for longer than two signals count as one
    process->send(SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(process->wait(), 0) << process->rest();
  EXPECT_TRUE(std::filesystem::exists(at("kept")));
}

TEST_F(Stopping, OfSeveralProcessesWaitsForAStoreThatIsSlowToWrite) {
  expect_all_kept(in_several(kSlow));
}

TEST_F(Stopping, WaitsForTheOthersWhenAProcessEndsByItself) {
  for (const int signal : {SIGINT, SIGKILL}) {
    const bool failed = signal == SIGKILL;
    const auto process = run(in_several(kSlow));
    ASSERT_EQ(manager_.receive(kPatience), "READY=1");
    const pid_t first = process->child_with("first");  // which writes nothing
    ASSERT_NE(first, 0);
    kill(first, signal);
    EXPECT_EQ(manager_.receive(kPatience), "STOPPING=1") << signal;
    EXPECT_EQ(process->wait(), failed ? 1 : 0) << process->rest();
    EXPECT_EQ(manager_.receive(), "") << "nothing is told twice";
    EXPECT_TRUE(std::filesystem::remove(at("kept"))) << signal;
  }
}

TEST_F(Stopping, FailsWhenAStoreCannotBeWritten) {
  constexpr const char* kFull = ", disk_is_full: true";
  for (const bool several : {false, true}) {
    const auto process = run(several ? in_several(kFull) : in_one_process(kFull));
    ASSERT_EQ(manager_.receive(kPatience), "READY=1");
    process->send(SIGTERM);
    EXPECT_EQ(process->wait(), 1);
    const std::string said = process->rest();
    EXPECT_NE(said.find("could not end well"), std::string::npos) << said;
    EXPECT_NE(said.find("has no space"), std::string::npos) << said;
    EXPECT_NE(said.find(several ? "process slow" : "process only"), std::string::npos) << said;
    EXPECT_EQ(manager_.receive(kPatience), "STOPPING=1");
  }
}

TEST_F(Stopping, OfOneProcessIsHurriedByASecondSignal) {
  const std::string said = said_when_hurried(in_one_process(kEndless));
  EXPECT_NE(said.find("interrupted a second time"), std::string::npos) << said;
}

TEST_F(Stopping, OfSeveralProcessesIsHurriedByASecondSignal) {
  const std::string said = said_when_hurried(in_several(kEndless));
  EXPECT_NE(said.find("process slow: killed in a hurry"), std::string::npos) << said;
}

TEST_F(Stopping, SaysWhichProcessFailedBeforeTheOthersHaveEnded) {
  const auto process = run(in_several(kEndless));
  ASSERT_EQ(manager_.receive(kPatience), "READY=1");
  const pid_t first = process->child_with("first");
  ASSERT_NE(first, 0);
  kill(first, SIGKILL);
  EXPECT_NE(process->wait_for_line("error: process first: ended early", kPatience), "");
  EXPECT_FALSE(std::filesystem::exists(at("kept")));
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (process->runs() && std::chrono::steady_clock::now() < deadline) {
    process->send(SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(process->wait(), 1);
  const std::string said = process->rest();
  EXPECT_NE(said.find("process first: ended early; then process slow killed in a hurry"),
            std::string::npos)
      << said;
}

/// Whether it is, also while nobody has asked for its exit code.
bool wait_until_dead(pid_t process, std::chrono::milliseconds patience) {
  const int descriptor = static_cast<int>(syscall(SYS_pidfd_open, process, 0));
  EXPECT_GE(descriptor, 0);
  pollfd end{descriptor, POLLIN, 0};
  const bool is_dead = poll(&end, 1, static_cast<int>(patience.count())) == 1;
  close(descriptor);
  return is_dead;
}

TEST_F(Stopping, NamesEveryProcessThatFailed) {
  const auto process = run("  - name: one\n" + component("SlowStore", "", "gate_one") +
                           "  - name: two\n" + component("SlowStore", "", "gate_two") +
                           "  - name: slow\n" + component("SlowStore", kSlow, "gate_slow"));
  ASSERT_EQ(manager_.receive(kPatience), "READY=1");
  process->send(SIGSTOP);  // so that it finds both at once
  const pid_t dying[] = {process->child_with("one"), process->child_with("two")};
  for (const pid_t child : dying) {
    ASSERT_NE(child, 0);
    kill(child, SIGKILL);
  }
  for (const pid_t child : dying) ASSERT_TRUE(wait_until_dead(child, kPatience));
  process->send(SIGCONT);
  EXPECT_EQ(process->wait(), 1);
  const std::string said = process->rest();
  EXPECT_NE(said.find("error: processes one, two: ended early"), std::string::npos) << said;
  EXPECT_TRUE(std::filesystem::exists(at("kept")));
}

TEST_F(Stopping, NamesEveryProcessThatCouldNotWrite) {
  constexpr const char* kFull = ", disk_is_full: true";
  const auto process = run("  - name: one\n" + component("SlowStore", kFull, "gate_one") +
                           "  - name: two\n" + component("SlowStore", kFull, "gate_two"));
  ASSERT_EQ(manager_.receive(kPatience), "READY=1");
  process->send(SIGTERM);
  EXPECT_EQ(process->wait(), 1);
  const std::string said = process->rest();
  EXPECT_NE(said.find("processes one, two: did not end well"), std::string::npos) << said;
}

}  // namespace
}  // namespace strata::tools
