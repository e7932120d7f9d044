// SPDX-License-Identifier: Apache-2.0
/// What `strata replay` can do besides replaying one log: several, given poses, truth, learning and
/// localizing in one composition, comparing with what came out before.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/log/log_reader.hpp"
#include "memory/store/store.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::bytes_of;
using test::expect_same_maps;
using test::kCompositions;
using test::Outcome;
using test::quoted;
using testing::HasSubstr;

/// Between two scans of the simulated log, on its first day.
constexpr double kLearned_s = 7.05;

class ReplayOptions : public test::ReplayFixture {
 protected:
  [[nodiscard]] static Outcome strata(const std::string& arguments) {
    return test::run_strata(arguments + " --quiet 2>&1");
  }
  [[nodiscard]] std::string domain() const {
    return " --set domain=" + std::to_string(test::own_domain());
  }
  [[nodiscard]] fs::path truth() const { return at("sim") / "truth.tum"; }

  /// Where the robot is at the first scan that is localized, as the localizer of a composition that
  /// has just learned works it out: the last learned pose, and the odometry since.
  [[nodiscard]] std::string first_pose(const fs::path& maps) const {
    const memory::Store store(maps / "strata.db", {.read_only = true});
    const memory::TrajectoryPose last = store.load_trajectory(0).back();
    const auto scans = log::read_observations(log());
    for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
      if (scans[i].scan.stamp != last.stamp) continue;
      const Pose2 pose =
          last.map_from_robot * between(scans[i].odom_from_robot, scans[i + 1].odom_from_robot);
      char text[100];
      std::snprintf(text, sizeof text, "%.17g,%.17g,%.17g", pose.x, pose.y, pose.theta);
      return text;
    }
    return "";
  }
};

class LearnAndLocalize : public ReplayOptions, public testing::WithParamInterface<const char*> {};

TEST_P(LearnAndLocalize, InOneCompositionGivesTheMapsAndPosesOfTheDirectCalls) {
  const std::string model = GetParam();
  const std::string split = std::to_string(kLearned_s);
  ASSERT_EQ(strata("learn " + quoted(log()) + " --to " + split + " --out " + quoted(at("m"))).code,
            0);
  const Outcome direct = strata(
      "localize " + quoted(log()) + " --from " + split + " --maps " + quoted(at("m")) +
      " --model " + model + " --initial-pose=" + first_pose(at("m")) + " --out " + quoted(at("l")));
  ASSERT_EQ(direct.code, 0) << direct.out;
  const Outcome outcome = replay(log(), kCompositions / "learn_and_localize.yaml", "both",
                                 "--learn-until " + split + " --set localizer.model=" + model);
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  const fs::path localized = at("both") / "localization";
  for (const char* file : {"trajectory.tum", "states.csv"}) {
    EXPECT_FALSE(bytes_of(localized / file).empty());
    EXPECT_EQ(bytes_of(localized / file), bytes_of(at("l") / file)) << file;
  }
  fs::remove_all(localized);
  expect_same_maps(at("m"), at("both"));
}

INSTANTIATE_TEST_SUITE_P(Models, LearnAndLocalize,
                         testing::Values("patch", "filtered", "timescale"));

TEST_F(ReplayOptions, SeveralRunsWithGivenPosesAndTruthGiveTheMapsOfTheDirectCall) {
  const std::string both = quoted(log()) + " " + quoted(log());
  const std::string files = " --poses " + quoted(truth()) + " --poses " + quoted(truth()) +
                            " --truth " + quoted(truth()) + " --truth " + quoted(truth());
  const Outcome direct = strata("learn " + both + files + " --out " + quoted(at("d")));
  ASSERT_EQ(direct.code, 0) << direct.out;
  const Outcome outcome =
      strata("replay " + both + files + domain() + " --composition " +
             quoted(kCompositions / "mapping_processes.yaml") + " --out " + quoted(at("r")));
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_EQ(test::summary_without_cost(at("r"))["runs"], 2);
  expect_same_maps(at("d"), at("r"));
}

TEST_F(ReplayOptions, TruthGivesTheErrorsOfTheDirectCall) {
  const std::string with_truth = " --truth " + quoted(truth());
  ASSERT_EQ(strata("learn " + quoted(log()) + with_truth + " --out " + quoted(at("m"))).code, 0);
  ASSERT_EQ(strata("localize " + quoted(log()) + with_truth + " --initial-pose 0,0,0 --maps " +
                   quoted(at("m")) + " --out " + quoted(at("l")))
                .code,
            0);
  const Outcome outcome =
      strata("replay " + quoted(log()) + with_truth + domain() + " --composition " +
             quoted(kCompositions / "localize.yaml") + " --set localizer.maps=" + at("m").string() +
             " --set localizer.start.pose=[0,0,0] --out " + quoted(at("r")));
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  const auto expected = nlohmann::json::parse(bytes_of(at("l") / "metrics.json"));
  const auto got = nlohmann::json::parse(bytes_of(at("r") / "metrics.json"));
  for (const char* key : {"mean", "median", "p95", "max", "rmse"}) {
    EXPECT_GT(expected["error_m"][key].get<double>(), 0.0);
    EXPECT_NEAR(got["error_m"][key].get<double>(), expected["error_m"][key].get<double>(), 1e-9);
    EXPECT_NEAR(got["error_rad"][key].get<double>(), expected["error_rad"][key].get<double>(),
                1e-9);
  }
  EXPECT_EQ(got["map_from_truth"], expected["map_from_truth"]);
}

/// Puts another text into a file, once.
void replace_in(const fs::path& file, std::size_t at, const std::string& with) {
  std::string text = bytes_of(file);
  text.replace(at, with.size(), with);
  std::ofstream(file, std::ios::binary) << text;
}

TEST_F(ReplayOptions, ExpectAcceptsComparesAndNamesTheFirstDifference) {
  const std::string command = "replay " + quoted(log()) + domain() + " --composition " +
                              quoted(kCompositions / "learn_and_localize.yaml") +
                              " --learn-until 7.05 --expect " + quoted(at("expected"));
  EXPECT_EQ(strata(command).code, 2) << "nothing is expected yet";
  const Outcome accepted =
      strata(command + " --accept --topics /amcl_pose /scan_pose /localization_health");
  ASSERT_EQ(accepted.code, 0) << accepted.out;
  EXPECT_TRUE(fs::exists(at("expected") / "tolerances.yaml"));
  EXPECT_TRUE(fs::exists(at("expected") / "topics" / "metadata.yaml"));
  EXPECT_FALSE(fs::exists(at("expected") / "strata.db"));

  const Outcome same = strata(command + " --out " + quoted(at("again")));
  EXPECT_EQ(same.code, 0) << same.out;
  EXPECT_TRUE(fs::exists(at("again") / "topics"));

  const fs::path trajectory = at("expected") / "localization" / "trajectory.tum";
  const std::string rows = bytes_of(trajectory);
  const std::size_t second_row = rows.find('\n') + 1;
  const std::size_t x = rows.find(' ', second_row) + 1;
  const std::string time = rows.substr(second_row, x - second_row - 1);
  replace_in(trajectory, rows.find('.', x) + 1, rows[rows.find('.', x) + 1] == '9' ? "8" : "9");
  const Outcome moved = strata(command);
  EXPECT_EQ(moved.code, 1);
  EXPECT_THAT(moved.out, HasSubstr("strata replay: error: " + at("expected").string()));
  EXPECT_THAT(moved.out, HasSubstr("localization/trajectory.tum at " + time));
  EXPECT_THAT(moved.out, HasSubstr(": x is "));
  EXPECT_FALSE(fs::exists(at("expected.replayed")));

  std::ofstream(at("expected") / "tolerances.yaml", std::ios::app)
      << "rules:\n  - {match: '*trajectory.tum:x', absolute: 1.0}\n";
  std::string tolerances = bytes_of(at("expected") / "tolerances.yaml");
  tolerances.erase(tolerances.find("rules: []"), std::string("rules: []").size());
  std::ofstream(at("expected") / "tolerances.yaml") << tolerances;
  const Outcome tolerated = strata(command);
  EXPECT_EQ(tolerated.code, 0) << tolerated.out;

  ASSERT_EQ(strata(command + " --accept").code, 0);
  EXPECT_EQ(bytes_of(trajectory), rows);
  EXPECT_TRUE(fs::exists(at("expected") / "topics")) << "what was recorded is recorded again";
  EXPECT_EQ(bytes_of(at("expected") / "tolerances.yaml"), tolerances);
}

TEST_F(ReplayOptions, AcceptDoesNotWipeAFolderOfOtherThings) {
  fs::create_directories(at("home"));
  std::ofstream(at("home") / "letter.txt") << "dear";
  const Outcome outcome =
      strata("replay " + quoted(log()) + domain() + " --composition " +
             quoted(kCompositions / "mapping.yaml") + " --accept --expect " + quoted(at("home")));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(bytes_of(at("home") / "letter.txt"), "dear");
}

TEST_F(ReplayOptions, ConfigTakesComponentsByNameAndRosParameterFiles) {
  std::ofstream(at("own.yaml")) << "version: 1\npatch_learner: {map_frame: floor}\n";
  std::ofstream(at("ros.yaml")) << "patch_learner:\n  ros__parameters:\n    map_frame: floor\n";
  const std::string command = "replay " + quoted(log()) + domain() + " --composition " +
                              quoted(kCompositions / "mapping.yaml") + " --topics /patch_map";
  for (const char* file : {"own.yaml", "ros.yaml"}) {
    const Outcome outcome =
        strata(command + " --config " + quoted(at(file)) + " --out " + quoted(at("o")));
    ASSERT_EQ(outcome.code, 0) << outcome.out;
    const std::string bag = bytes_of(at("o") / "topics" / "topics_0.mcap");
    EXPECT_NE(bag.find("floor"), std::string::npos) << file;
  }
  std::ofstream(at("typo.yaml")) << "version: 1\npatch_lerner: {map_frame: floor}\n";
  const Outcome typo =
      strata(command + " --config " + quoted(at("typo.yaml")) + " --out " + quoted(at("t")));
  EXPECT_EQ(typo.code, 2);
  EXPECT_THAT(typo.out, HasSubstr("typo.yaml:2"));
  EXPECT_THAT(typo.out, HasSubstr("did you mean 'patch_learner'?"));
}

TEST(RunCheck, ExplainsWhoTalksToWhomAndStartsNothing) {
  const strata::test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "c.yaml")
      << "version: 1\nnamespace: /robot1\nprocesses:\n  - name: first\n    components:\n"
         "      - {type: strata::ScanMatcher, name: matcher, remappings: {scan: /front/scan}}\n"
         "      - {type: strata::Recorder, name: recorder, parameters: {out: "
      << (folder.path() / "bag").string()
      << ", topics: ['scan_pose:strata_msgs/msg/ScanPose']}}\n"
         "  - name: second\n    components:\n"
         "      - {type: strata::BeamFilter, name: filter}\n";
  const Outcome outcome = test::run_strata("run --check " + quoted(folder.path() / "c.yaml"));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("process second"));
  EXPECT_THAT(outcome.out, HasSubstr("/robot1/matcher  (strata::ScanMatcher)"));
  EXPECT_THAT(outcome.out, HasSubstr("reads  /front/scan  sensor_msgs/msg/LaserScan  "
                                     "[best effort, last 5]  from outside"));
  EXPECT_THAT(outcome.out, HasSubstr("writes /robot1/posed_scan  strata_msgs/msg/LabeledScan  "
                                     "[reliable, last 10]  for /robot1/filter"));
  EXPECT_FALSE(fs::exists(folder.path() / "bag"));
}

TEST(RunCheck, NamesTheLikelyTypeOfATypo) {
  const strata::test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "c.yaml")
      << "version: 1\nprocesses:\n  - name: p\n    components:\n"
         "      - {type: strata::ScanMacher, name: matcher}\n";
  const Outcome outcome =
      test::run_strata("run --check " + quoted(folder.path() / "c.yaml") + " 2>&1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("c.yaml:5"));
  EXPECT_THAT(outcome.out, HasSubstr("did you mean 'strata::ScanMatcher'?"));
}

}  // namespace
}  // namespace strata::tools
