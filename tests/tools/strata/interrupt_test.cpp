// SPDX-License-Identifier: Apache-2.0
/// Ctrl-C at any moment: the program ends by itself, and what it leaves is whole or not there.
///
/// The moments are spread over the time that the same command takes undisturbed, from a fixed seed.
/// `timeout` sends SIGINT and, a minute later, would kill; nothing here asserts a speed.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "core/base/error.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::Outcome;
using test::quoted;

constexpr int kInterrupts = 4;
constexpr int kInterrupted = 1;
constexpr int kDiedBeforeMain = 128 + 2;  // the signal came while the program was being loaded

/// One moment in each of `count` equal parts of the time.
std::vector<double> moments(double whole_s, int count) {
  std::mt19937 random(20);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same moments every time
  std::vector<double> result;
  for (int i = 0; i < count; ++i) {
    const double place = static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
    result.push_back(whole_s * (i + place) / count);
  }
  return result;
}

Outcome interrupted_after(double seconds, const std::string& arguments) {
  return test::run_strata_under("timeout --preserve-status --kill-after=60 --signal=INT " +
                                    std::to_string(std::max(seconds, 0.001)),
                                arguments + " 2>&1");
}

std::set<std::string> file_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& [name, bytes] : test::contents(folder)) names.insert(name);
  return names;
}

class Interrupted : public test::ReplayFixture {
 protected:
  /// Runs the command to its end, then again and again with an interrupt; each time its folder is
  /// as in the whole run or not there, and nothing lies beside it.
  void expect_whole_or_nothing(const std::string& arguments) {
    const fs::path whole = at("whole");
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome =
        test::run_strata(arguments + " --quiet --out " + quoted(whole) + " 2>&1");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    ASSERT_EQ(outcome.code, 0) << outcome.out;
    const fs::path folder = at("interrupted");
    for (const double moment : moments(took.count(), kInterrupts)) {
      fs::create_directories(folder);
      const Outcome cut =
          interrupted_after(moment, arguments + " --quiet --out " + quoted(folder / "out"));
      EXPECT_TRUE(cut.code == 0 || cut.code == kInterrupted || cut.code == kDiedBeforeMain)
          << cut.code << " after " << moment << " s: " << cut.out;
      EXPECT_EQ(fs::exists(folder / "out"), cut.code == 0) << "after " << moment << " s";
      if (cut.code == 0) {
        EXPECT_EQ(file_names(folder / "out"), file_names(whole));
      }
      fs::remove_all(folder / "out");
      EXPECT_TRUE(fs::is_empty(folder)) << fs::directory_iterator(folder)->path();
      fs::remove_all(folder);
    }
  }

  /// A bag that was being recorded reads without damage; the number of its messages.
  [[nodiscard]] static std::size_t expect_readable(const fs::path& bag) {
    const auto reader = log::BagReader::open(bag);
    log::BagMessage message;
    std::size_t count = 0;
    while (reader->next(message)) ++count;
    EXPECT_EQ(reader->damage().count, 0U) << reader->damage().first;
    return count;
  }

  [[nodiscard]] std::string domain() const {
    return " --set domain=" + std::to_string(test::own_domain());
  }
  [[nodiscard]] std::string composition(const std::string& name) const {
    return " --composition " + quoted(test::kCompositions / name) + domain();
  }

  /// Everything at once, live: a player, every component that learns, a recorder.
  void write_live_composition(const std::string& storage) const {
    std::ofstream file(at("live.yaml"));
    file << "version: 1\ntransport: loopback\nprocesses:\n  - name: robot\n    components:\n"
            "      - {type: strata::Recorder, name: recorder, parameters: {storage: "
         << storage << ", out: " << at("bag").string()
         << ", topics: ['/scan:sensor_msgs/msg/LaserScan', '/odom:nav_msgs/msg/Odometry']}}\n"
            "      - {type: strata::Player, name: player, parameters: {rate: 4, log: "
         << log().string()
         << "}}\n"
            "  - name: maps\n    components:\n"
            "      - {type: strata::ScanMatcher, name: matcher}\n"
            "      - {type: strata::BeamFilter, name: filter}\n"
            "      - {type: strata::PatchLearner, name: learner, "
            "parameters: {learn_every_scans: 10}}\n"
            "      - {type: strata::TimescaleMemory, name: memory}\n";
  }
};

TEST_F(Interrupted, LearnLeavesAllOfItsMapsOrNothing) {
  expect_whole_or_nothing("learn " + quoted(log()));
}

TEST_F(Interrupted, LearnThatIsKilledLeavesNothingThatLooksWholeAndRunsAgain) {
  const std::string command = "learn --quiet " + quoted(log()) + " --out " + quoted(at("killed"));
  for (const double moment : moments(0.4, kInterrupts)) {
    (void)test::run_strata_under("timeout --signal=KILL " + std::to_string(moment), command);
    if (fs::exists(at("killed"))) {
      EXPECT_EQ(file_names(at("killed")), file_names(at("direct"))) << moment;
    }
    fs::remove_all(at("killed"));
  }
  EXPECT_EQ(test::run_strata(command).code, 0);
  test::expect_same_maps(at("killed"), at("direct"));
}

/// No file may become larger than a few kilobytes, which to a program is a full disk.
TEST_F(Interrupted, AFullDiskIsOneLineAndLeavesNothing) {
  const std::string full_disk = "ulimit -f 8; trap '' XFSZ;";
  fs::create_directories(at("full"));
  const Outcome outcome =
      test::run_strata_under(full_disk, "learn --quiet " + quoted(log()) + " --out " +
                                            quoted(at("full") / "out") + " 2>&1");
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  EXPECT_NE(outcome.out.find(": error: "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("; "), std::string::npos) << "no remedy: " << outcome.out;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1) << outcome.out;
  EXPECT_TRUE(fs::is_empty(at("full"))) << *fs::directory_iterator(at("full"));
}

TEST_F(Interrupted, LocalizeLeavesAllOfItsFilesOrNothing) {
  expect_whole_or_nothing("localize " + quoted(log()) + " --maps " + quoted(at("direct")));
}

TEST_F(Interrupted, CompareLeavesAWholeReportOrNothing) {
  expect_whole_or_nothing("compare " + quoted(log()) + " --seeds 1");
}

TEST_F(Interrupted, ReplayInOneProcessLeavesAllOfItsMapsOrNothing) {
  expect_whole_or_nothing("replay " + quoted(log()) + composition("mapping.yaml"));
}

TEST_F(Interrupted, ReplayInSeveralProcessesLeavesAllOfItsMapsOrNothing) {
  expect_whole_or_nothing("replay " + quoted(log()) + composition("mapping_processes.yaml"));
}

TEST_F(Interrupted, RunLeavesABagThatReadsWithoutDamage) {
  constexpr double kLongest_s = 3.0;
  for (const char* storage : {"sqlite3", "mcap"}) {
    write_live_composition(storage);
    std::size_t most = 0;
    for (const double moment : moments(kLongest_s, kInterrupts / 2)) {
      const Outcome cut =
          interrupted_after(moment, "run --quiet " + quoted(at("live.yaml")) + domain());
      EXPECT_TRUE(cut.code == 0 || cut.code == kDiedBeforeMain) << cut.code << ": " << cut.out;
      if (fs::exists(at("bag"))) most = std::max(most, expect_readable(at("bag")));
      fs::remove_all(at("bag"));
    }
    EXPECT_GT(most, 0U) << storage;
  }
}

TEST_F(Interrupted, RecordLeavesABagThatReadsWithoutDamage) {
  constexpr double kLongest_s = 1.0;
  for (const double moment : moments(kLongest_s, kInterrupts / 2)) {
    const Outcome cut =
        interrupted_after(moment, "record --quiet --transport loopback --out " + quoted(at("bag")) +
                                      " --domain " + std::to_string(test::own_domain()));
    EXPECT_TRUE(cut.code == 0 || cut.code == kDiedBeforeMain) << cut.code << ": " << cut.out;
    if (fs::exists(at("bag"))) {
      EXPECT_EQ(expect_readable(at("bag")), 0U);
      EXPECT_TRUE(fs::exists(at("bag") / "metadata.yaml"));
    }
    fs::remove_all(at("bag"));
  }
}

/// The program in the background, killed at the end of the scope.
class Background {
 public:
  explicit Background(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), STRATA_PROGRAM);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&pid_, STRATA_PROGRAM, nullptr, nullptr, argv.data(), environ), 0);
  }
  ~Background() { kill_hard(); }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  void kill_hard() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  [[nodiscard]] bool runs() const { return waitpid(pid_, nullptr, WNOHANG) == 0; }
  /// The processes that it started.
  [[nodiscard]] std::set<pid_t> children() const {
    const std::string pid = std::to_string(pid_);
    std::ifstream in("/proc/" + pid + "/task/" + pid + "/children");
    return {std::istream_iterator<pid_t>(in), {}};
  }

 private:
  pid_t pid_ = -1;
};

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

TEST_F(Interrupted, WhatWasRecordedIsReadableAfterKill9) {
  for (const char* storage : {"sqlite3", "mcap"}) {
    std::ofstream(at("kill.yaml"))
        << "version: 1\ntransport: loopback\nprocesses:\n  - name: p\n    components:\n"
           "      - {type: strata::Recorder, name: recorder, parameters: {storage: "
        << storage << ", out: " << at("bag").string()
        << ", topics: ['/scan:sensor_msgs/msg/LaserScan']}}\n"
           "      - {type: strata::Player, name: player, parameters: {rate: 1000, log: "
        << log().string() << "}}\n";
    const std::size_t scans = log::read_observations(log()).size();
    Background run({"run", "--quiet", at("kill.yaml").string(), "--set",
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

bool comes_true(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
  }
  return true;
}

TEST_F(Interrupted, AProcessThatDiesIsStartedAgainAsItsPolicySays) {
  std::ofstream(at("restart.yaml"))
      << "version: 1\ntransport: loopback\nprocesses:\n"
         "  - name: one\n    restart: on_failure\n    restart_delay_s: 0\n"
         "    components: [{type: strata::BeamFilter, name: one}]\n"
         "  - name: two\n"
         "    components: [{type: strata::BeamFilter, name: two}]\n";
  const Background run({"run", "--quiet", at("restart.yaml").string(), "--set",
                        "domain=" + std::to_string(test::own_domain())});
  ASSERT_TRUE(comes_true([&] { return run.children().size() == 2; }));
  const pid_t first = *run.children().begin();  // started first, so `one` has the smaller number
  kill(first, SIGKILL);
  EXPECT_TRUE(comes_true([&] {
    const std::set<pid_t> now = run.children();
    return now.size() == 2 && now.count(first) == 0;
  }));
  kill(*run.children().begin(), SIGKILL);
  EXPECT_TRUE(comes_true([&] { return !run.runs(); })) << "`two` has no policy to come back";
}

}  // namespace
}  // namespace strata::tools
