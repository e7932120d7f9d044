// SPDX-License-Identifier: Apache-2.0
/// The processes of a replay: what they keep of the one that started them, and how they end.
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "tests/support/child_process.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::comes_true;

/// "pipe:[NUMBER]" of each that the process has beside its standard ones.
std::set<std::string> pipes_of(pid_t process) {
  std::set<std::string> pipes;
  std::error_code gone;
  const fs::path folder = fs::path("/proc") / std::to_string(process) / "fd";
  for (const auto& entry : fs::directory_iterator(folder, gone)) {
    const std::string target = fs::read_symlink(entry.path(), gone).string();
    if (std::stoi(entry.path().filename().string()) > 2 && target.rfind("pipe:", 0) == 0) {
      pipes.insert(target);
    }
  }
  return pipes;
}

/// Both of its processes have told that they work, and closed what they told it by.
bool is_let_go(const test::ChildProcess& replay) {
  std::set<std::string> given = pipes_of(replay.pid());
  for (const std::string& pipe : pipes_of(getpid())) given.erase(pipe);  // from whoever runs this
  const std::set<pid_t> children = replay.children();
  if (children.size() != 2 || given.size() != 2) return false;
  for (const pid_t child : children) {
    for (const std::string& pipe : pipes_of(child)) {
      if (given.count(pipe) > 0) return false;
    }
  }
  return true;
}

class ProcessesOfAReplay : public test::ReplayFixture {
 protected:
  /// One with a filter, one whose component writes for so long at its end.
  [[nodiscard]] std::vector<std::string> command(double takes_s, double rate) const {
    std::ofstream(at("two.yaml"))
        << "version: 1\ntransport: loopback\nlibraries: [" STRATA_TEST_GATE
           "]\nprocesses:\n  - {name: one, components: [{type: strata::BeamFilter, name: filter}]}"
           "\n  - name: two\n    components: [{type: gate::SlowStore, name: slow, parameters: "
           "{folder: '"
        << at("").string() << "', takes_s: " << takes_s << "}}]\n";
    return {STRATA_PROGRAM,
            "replay",
            log().string(),
            "--composition=" + at("two.yaml").string(),
            "--out=" + at("out").string(),
            "--rate=" + std::to_string(rate),
            "--set=domain=" + std::to_string(test::own_domain())};
  }
};

TEST_F(ProcessesOfAReplay, KeepNoPipeToTheOneThatStartedThem) {
  const test::ChildProcess replay(command(0.0, 0.1));
  EXPECT_TRUE(comes_true([&] { return is_let_go(replay); }));
}

TEST_F(ProcessesOfAReplay, HaveTheirTimeToWriteAtItsEnd) {
  test::ChildProcess replay(command(3.0, 1000.0));
  EXPECT_EQ(replay.wait(), 0) << replay.rest();
  EXPECT_TRUE(fs::exists(at("kept")));
}

TEST_F(ProcessesOfAReplay, AreNotBlamedWhenItIsInterruptedWhileTheyWrite) {
  test::ChildProcess replay(command(10000.0, 1000.0), {}, test::ChildProcess::Errors::kMerged);
  ASSERT_TRUE(comes_true([&] { return fs::exists(at("begun")); }));
  replay.send(SIGINT);
  EXPECT_EQ(replay.wait(), 1);
  const std::string said = replay.rest();
  // Where unwinding takes longer than its grace, the end is a hard one, and says another thing.
  const bool is_soft = said.find("error: replay: stopped on request") != std::string::npos;
  const bool is_hard = said.find("error: interrupted; run the command again") != std::string::npos;
  EXPECT_NE(is_soft, is_hard) << said;
  EXPECT_EQ(said.find("process two"), std::string::npos) << said;
  EXPECT_FALSE(fs::exists(at("out")));
}

TEST_F(ProcessesOfAReplay, WriteNothingWhenItIsKilled) {
  test::ChildProcess replay(command(0.0, 0.1));
  ASSERT_TRUE(comes_true([&] { return fs::exists(at("active")); }));
  const std::set<pid_t> children = replay.children();
  replay.kill_hard();
  for (const pid_t child : children) {
    EXPECT_TRUE(comes_true([&] { return !fs::exists("/proc/" + std::to_string(child) + "/exe"); }));
  }
  EXPECT_FALSE(fs::exists(at("begun")));
}

}  // namespace
}  // namespace strata::tools
