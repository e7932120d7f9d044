// SPDX-License-Identifier: Apache-2.0
/// `kill -9` at any moment: what was learned or recorded before is readable, and processes come
/// back.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>

#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "core/base/error.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/shared_segments.hpp"
#include "tests/tools/strata/moments.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::comes_true;
using test::file_names;
using test::moments;
using test::quoted;

class Killed : public test::ReplayFixture {};

TEST_F(Killed, LearnLeavesNothingThatLooksWholeAndRunsAgain) {
  const std::string command = "learn --quiet " + quoted(log()) + " --out " + quoted(at("killed"));
  for (const double moment : moments(0.4, 4)) {
    (void)test::run_strata_under("timeout --signal=KILL " + std::to_string(moment), command);
    if (fs::exists(at("killed"))) {
      EXPECT_EQ(file_names(at("killed")), file_names(at("direct"))) << moment;
    }
    fs::remove_all(at("killed"));
  }
  EXPECT_EQ(test::run_strata(command).code, 0);
  test::expect_same_maps(at("killed"), at("direct"));
}

std::size_t readable_messages(const fs::path& bag) {
  if (!fs::exists(bag) || fs::is_empty(bag)) return 0;
  try {
    const auto reader = log::BagReader::open(bag);
    log::BagMessage message;
    std::size_t count = 0;
    while (reader->next(message)) ++count;
    return count;
  } catch (const InputError&) {
    return 0;  // it was only just begun
  }
}

TEST_F(Killed, RecorderLeavesWhatItRecordedReadable) {
  for (const char* storage : {"sqlite3", "mcap"}) {
    std::ofstream(at("kill.yaml"))
        << "version: 1\ntransport: loopback\nprocesses:\n  - name: p\n    components:\n"
           "      - {type: strata::Recorder, name: recorder, parameters: {storage: "
        << storage << ", out: " << at("bag").string()
        << ", topics: ['/scan:sensor_msgs/msg/LaserScan']}}\n"
           "      - {type: strata::Player, name: player, parameters: {rate: 1000, log: "
        << log().string() << "}}\n";
    const std::size_t scans = log::read_observations(log()).size();
    test::ChildProcess run({STRATA_PROGRAM, "run", "--quiet", at("kill.yaml").string(), "--set",
                            "domain=" + std::to_string(test::own_domain())});
    // Nothing comes any more once all has been played: the recorder itself has to bring it out.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (readable_messages(at("bag")) < scans && std::chrono::steady_clock::now() < deadline) {
      ASSERT_TRUE(run.runs());
    }
    run.kill_hard();
    // MCAP's end mark is missing, which the reader counts; of the messages nothing is.
    EXPECT_EQ(readable_messages(at("bag")), scans) << storage;
    fs::remove_all(at("bag"));
  }
}

TEST_F(Killed, AProcessThatDiesIsStartedAgainAsItsPolicySays) {
  std::ofstream(at("restart.yaml"))
      << "version: 1\ntransport: loopback\nprocesses:\n"
         "  - name: one\n    restart: on_failure\n    restart_delay_s: 0\n"
         "    components: [{type: strata::BeamFilter, name: one}]\n"
         "  - name: two\n"
         "    components: [{type: strata::BeamFilter, name: two}]\n"
         "  - name: three\n    restart: always\n    restart_delay_s: 0\n"
         "    components: [{type: strata::BeamFilter, name: three}]\n";
  test::ChildProcess run({STRATA_PROGRAM, "run", "--quiet", at("restart.yaml").string(), "--set",
                          "domain=" + std::to_string(test::own_domain())});
  // A process that has just begun has its parent's command line; the last may be ready first.
  pid_t one = 0;
  pid_t two = 0;
  pid_t three = 0;
  ASSERT_TRUE(comes_true([&] {
    one = run.child_with("one");
    two = run.child_with("two");
    three = run.child_with("three");
    return one != 0 && two != 0 && three != 0;
  }));
  const auto is_replaced = [&](pid_t gone) {
    return comes_true([&] {
      const std::set<pid_t> now = run.children();
      return now.size() == 3 && now.count(gone) == 0;
    });
  };
  kill(one, SIGKILL);
  EXPECT_TRUE(is_replaced(one));
  kill(three, SIGINT);  // it ends well, which is no failure
  EXPECT_TRUE(is_replaced(three));
  kill(two, SIGKILL);
  EXPECT_TRUE(comes_true([&] { return !run.runs(); })) << "`two` has no policy to come back";
}

TEST_F(Killed, RunLeavesSharedMemoryThatTheNextOneRemoves) {
  std::ofstream(at("shared.yaml"))
      << "version: 1\ntransport: shared_memory\nprocesses:\n  - name: p\n    components:\n"
         "      - {type: strata::ScanMatcher, name: matcher}\n";
  const std::vector<std::string> command = {STRATA_PROGRAM, "run", at("shared.yaml").string(),
                                            "--set",
                                            "domain=" + std::to_string(test::own_domain())};
  std::set<fs::path> locks;
  {
    test::ChildProcess run(command, {}, test::ChildProcess::Errors::kMerged);
    ASSERT_NE(run.wait_for_line("process p runs"), "");
    locks = test::segment_locks_of(std::to_string(run.pid()));
    run.kill_hard();
  }
  ASSERT_FALSE(locks.empty());
  for (const fs::path& lock : locks) {
    ASSERT_TRUE(fs::exists(test::segment_of_lock(lock))) << lock;
    fs::last_write_time(lock, fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
  test::ChildProcess again(command, {}, test::ChildProcess::Errors::kMerged);
  ASSERT_NE(again.wait_for_line("process p runs"), "");
  for (const fs::path& lock : locks) {
    EXPECT_FALSE(fs::exists(lock)) << lock;
    EXPECT_FALSE(fs::exists(test::segment_of_lock(lock))) << lock;
  }
}

}  // namespace
}  // namespace strata::tools
