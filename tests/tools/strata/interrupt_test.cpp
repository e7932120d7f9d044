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
#include "tests/tools/strata/moments.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::file_names;
using test::moments;
using test::Outcome;
using test::quoted;

constexpr int kInterrupts = 4;
constexpr int kInterrupted = 1;
constexpr int kDiedBeforeMain = 128 + 2;  // the signal came while the program was being loaded

Outcome interrupted_after(double seconds, const std::string& arguments) {
  return test::run_strata_under("timeout --preserve-status --kill-after=60 --signal=INT " +
                                    std::to_string(std::max(seconds, 0.001)),
                                arguments + " 2>&1");
}

class Interrupted : public test::ReplayFixture {
 protected:
  /// Runs the command to its end, then again and again with an interrupt; each time its folder is
  /// as in the whole run or not there, and nothing lies beside it. out: how the command is told the
  /// folder.
  void expect_whole_or_nothing(const std::string& arguments, const std::string& out = " --out ") {
    const fs::path whole = at("whole") / "out";
    fs::create_directories(at("whole"));
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome =
        test::run_strata(arguments + " --quiet" + out + quoted(whole) + " 2>&1");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    ASSERT_EQ(outcome.code, 0) << outcome.out;
    const fs::path folder = at("interrupted");
    for (const double moment : moments(took.count(), kInterrupts)) {
      fs::create_directories(folder);
      const Outcome cut =
          interrupted_after(moment, arguments + " --quiet" + out + quoted(folder / "out"));
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

  /// A bag that was being recorded reads without damage; the number of messages of others in it.
  [[nodiscard]] static std::size_t expect_readable(const fs::path& bag) {
    const auto reader = log::BagReader::open(bag);
    log::BagMessage message;
    std::size_t count = 0;
    while (reader->next(message)) {  // the recorder's own log is there too
      if (reader->topics()[message.topic].name != "/rosout") ++count;
    }
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

TEST_F(Interrupted, SimulateLeavesAWholeWorldOrNothing) {
  expect_whole_or_nothing("simulate " + quoted(scenario()));
}

TEST_F(Interrupted, ConvertLeavesAWholeBagOrNothing) {
  expect_whole_or_nothing("convert --to mcap " + quoted(log()), " ");
}

TEST_F(Interrupted, TopologyLeavesAllOfItsFilesOrNothing) {
  std::ofstream(at("landmarks.txt")) << "1\n5\n9\n";
  expect_whole_or_nothing("topology " + quoted(log()) + " --landmarks " +
                          quoted(at("landmarks.txt")));
}

TEST_F(Interrupted, VolumeLeavesAllOfItsFilesOrNothing) {
  std::ofstream points(at("clouds.log"));
  for (int scan = 0; scan < 20; ++scan) {
    points << "NODE " << 0.1 * scan << " 0 0 0 0 0\n";
    for (int i = 0; i < 2000; ++i) points << "4 " << 0.003 * i - 3.0 << ' ' << 0.1 * scan << '\n';
  }
  points.close();
  expect_whole_or_nothing("volume " + quoted(at("clouds.log")));
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

}  // namespace
}  // namespace strata::tools
