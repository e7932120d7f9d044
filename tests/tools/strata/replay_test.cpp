// SPDX-License-Identifier: Apache-2.0
/// `strata replay` against `strata learn`: over DDS the same maps come out, bit for bit.
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/bus/domain_claim.hpp"
#include "tests/support/child_process.hpp"
#include "tests/tools/strata/replay_fixture.hpp"
#include "tools/strata/paced_time.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::bytes_of;
using test::expect_same_maps;
using test::kCompositions;
using test::quoted;

class Replay : public test::ReplayFixture {};

TEST_F(Replay, InOneProcessGivesTheMapsOfTheDirectCall) {
  const test::Outcome outcome = replay(log(), kCompositions / "mapping.yaml", "one");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  expect_same_maps(at("direct"), at("one"));
}

TEST_F(Replay, InSeveralProcessesGivesTheMapsOfTheDirectCall) {
  const test::Outcome outcome = replay(log(), kCompositions / "mapping_processes.yaml", "many");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  expect_same_maps(at("direct"), at("many"));
}

TEST_F(Replay, DoesNotDependOnThreadsExecutorOrTransport) {
  const test::Outcome outcome = replay(log(), kCompositions / "mapping.yaml", "other",
                                       "--threads 2 --set transport=shared_memory "
                                       "--set 'processes[0].executor=single_threaded'");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  expect_same_maps(at("direct"), at("other"));
}

TEST_F(Replay, DoesNotDependOnItsSpeed) {
  constexpr double kRate = 20.0;
  const test::Outcome outcome =
      replay(log(), kCompositions / "mapping.yaml", "paced", "--rate " + std::to_string(kRate));
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  expect_same_maps(at("direct"), at("paced"));
  // A pose a scan; nights are cut short.
  std::ifstream trajectory(at("paced") / "trajectory.tum");
  PacedTime time(kRate);
  std::optional<double> first_s;
  double due_s = 0.0;
  for (std::string line; std::getline(trajectory, line);) {
    const double stamp_s = std::stod(line);
    if (!first_s) first_s = stamp_s;
    due_s = time.due_s(stamp_s - *first_s);
  }
  EXPECT_GT(due_s, 0.1);
  const auto summary = nlohmann::json::parse(bytes_of(at("paced") / "summary.json"));
  EXPECT_GE(summary["cost"]["wall_s"].get<double>(), due_s) << "it kept the pace";
}

TEST_F(Replay, MeasuresWhatItCost) {
  ASSERT_EQ(replay(log(), kCompositions / "mapping_processes.yaml", "out").code, 0);
  const auto cost = nlohmann::json::parse(bytes_of(at("out") / "summary.json"))["cost"];
  for (const char* key : {"wall_s", "cpu_s", "peak_rss_mb", "real_time_factor"}) {
    EXPECT_GT(cost[key].get<double>(), 0.0) << key;
  }
}

TEST_F(Replay, ThatFailsSaysWhichComponentAndLeavesNothing) {
  std::ofstream(at("alone.yaml"))
      << "version: 1\ntransport: loopback\nprocesses:\n"
         "  - {name: p, components: [{type: strata::PatchLearner, name: learner}]}\n";
  const test::Outcome outcome = replay(log(), at("alone.yaml"), "none");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, testing::HasSubstr("/learner: "));
  EXPECT_THAT(outcome.out, testing::HasSubstr("no filtered map came"));
  EXPECT_FALSE(fs::exists(at("none")));
}

TEST_F(Replay, RefusesSettingsThatWouldNotApply) {
  const test::Outcome typo =
      replay(log(), kCompositions / "mapping.yaml", "none",
             "--set 'processes[0].components[0].parameters.slam.resolutionm=0.1'");
  EXPECT_EQ(typo.code, 2);
  EXPECT_THAT(typo.out, testing::HasSubstr("slam.resolutionm is an unknown key"));
}

TEST_F(Replay, WaitsForAnotherOnItsDomain) {
  auto other = bus::DomainClaim::take("replay", test::own_domain());
  ASSERT_TRUE(other);
  test::ChildProcess waits(
      {STRATA_PROGRAM, "replay", log().string(), "--composition",
       (kCompositions / "mapping.yaml").string(), "--out", at("waited").string(), "--set",
       "domain=" + std::to_string(test::own_domain())},
      {}, test::ChildProcess::Errors::kMerged);
  EXPECT_NE(waits.wait_for_line("another replay is on domain"), "");
  EXPECT_TRUE(waits.runs());
  EXPECT_FALSE(fs::exists(at("waited")));
  other.reset();
  EXPECT_EQ(waits.wait(), 0) << waits.rest();
  expect_same_maps(at("direct"), at("waited"));
}

/// `timeout` sends SIGINT after three seconds and would report 137 had it to kill.
test::Outcome interrupted(const std::string& arguments) {
  return test::run_strata_under("timeout --preserve-status --kill-after=60 --signal=INT 3",
                                arguments + " 2>&1");
}

TEST_F(Replay, RunOfAPlayerAndARecorderEndsWithCtrlCAndLeavesAReadableBag) {
  std::ofstream(at("record.yaml"))
      << "version: 1\ntransport: loopback\nprocesses:\n  - name: p\n    components:\n"
         "      - {type: strata::Recorder, name: recorder, parameters: {out: "
      << at("bag").string()
      << ", topics: ['/scan:sensor_msgs/msg/LaserScan', '/odom:nav_msgs/msg/Odometry']}}\n"
         "      - {type: strata::Player, name: player, parameters: {rate: 20, log: "
      << log().string() << "}}\n";
  const test::Outcome run = interrupted("run --quiet " + quoted(at("record.yaml")) +
                                        " --set domain=" + std::to_string(test::own_domain()));
  EXPECT_EQ(run.code, 0) << run.out;
  const test::Outcome info = test::run_strata("info --json --quiet " + quoted(at("bag")));
  ASSERT_EQ(info.code, 0);
  const auto read = nlohmann::json::parse(info.out);
  EXPECT_GT(read["scans"]["count"].get<int>(), 0);
  EXPECT_GT(read["messages"]["/odom"]["count"].get<int>(), 0);
}

TEST_F(Replay, RecordEndsWithCtrlCAndLeavesACompleteBag) {
  const test::Outcome record =
      interrupted("record --quiet --transport loopback --out " + quoted(at("bag")) + " --domain " +
                  std::to_string(test::own_domain()));
  EXPECT_EQ(record.code, 0) << record.out;
  EXPECT_TRUE(fs::exists(at("bag") / "metadata.yaml"));
}

TEST(ReplayOfARealLog, GivesTheMapsOfTheDirectCall) {
  STRATA_REQUIRE_DATA(log, "fr079/fr079.clf.gz");
  const strata::test::TemporaryDirectory folder;
  const auto direct = folder.path() / "direct";
  ASSERT_EQ(
      test::run_strata("learn --quiet --to 20 " + quoted(log) + " --out " + quoted(direct)).code,
      0);
  const auto replayed = folder.path() / "replayed";
  const test::Outcome outcome = test::run_strata(
      "replay --quiet --to 20 " + quoted(log) + " --composition " +
      quoted(kCompositions / "mapping_processes.yaml") + " --out " + quoted(replayed) +
      " --set domain=" + std::to_string(test::own_domain()) + " 2>&1");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  expect_same_maps(direct, replayed);
}

TEST(ReplayOfARealLog, GivesTheTopologiesOfTheDirectCall) {
  STRATA_REQUIRE_DATA(log, "fr079/fr079.clf.gz");
  const strata::test::TemporaryDirectory folder;
  const std::string part = " --quiet --to 150 " + quoted(log);
  const auto direct = folder.path() / "direct";
  ASSERT_EQ(test::run_strata("topology" + part + " --out " + quoted(direct)).code, 0);
  const auto replayed = folder.path() / "replayed";
  const test::Outcome outcome = test::run_strata(
      "replay" + part + " --composition " + quoted(kCompositions / "topology.yaml") +
      " --threads 2 --out " + quoted(replayed) +
      " --set domain=" + std::to_string(test::own_domain()) + " 2>&1");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  test::expect_same_topologies(direct, replayed / "topology");
}

}  // namespace
}  // namespace strata::tools
