// SPDX-License-Identifier: Apache-2.0
/// The program as users and scripts meet it: exit codes, error lines, files.
#include "tests/tools/strata/program.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/wait.h>

#include "components/maps/map_models.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::Outcome;
using test::quoted;

Outcome run(const std::string& arguments) { return test::run_strata(arguments); }

TEST(Program, SaysThatAVerbDoesNotExistEvenWhenAskedForItsHelp) {
  for (const std::string arguments : {"lern", "lern --help"}) {
    const Outcome outcome = run(arguments + " 2>&1");
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_THAT(outcome.out, ::testing::HasSubstr("did you mean 'learn'"));
  }
}

TEST(Program, BadUsageEndsWithTwoAndOneLine) {
  for (const char* arguments : {"info", "info a --nonsense", "nonsense", "info a --threads -1"}) {
    const Outcome outcome = run(std::string(arguments) + " 2>&1");
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_THAT(outcome.out, ::testing::StartsWith("strata ")) << arguments;
    EXPECT_THAT(outcome.out, ::testing::HasSubstr(": error: command line: ")) << arguments;
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1) << outcome.out;
  }
  EXPECT_EQ(run("2>/dev/null").code, 2);
}

/// The names of verb_NAME.cpp, but for what verbs share.
std::vector<std::string> verbs() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(STRATA_SOURCE_DIR) / "tools/strata")) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".cpp" || !stem.starts_with("verb_")) continue;
    if (stem != "verb_context") names.push_back(stem.substr(5));
  }
  return names;
}

TEST(Program, HelpHasAnExampleForEveryVerb) {
  const Outcome all = run("--help");
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(verbs(), ::testing::IsSupersetOf({"info", "convert", "evaluate"}));
  for (const std::string& verb : verbs()) {
    EXPECT_THAT(all.out, ::testing::ContainsRegex("\n +" + verb + " "));
    const Outcome help = run(verb + " --help");
    EXPECT_EQ(help.code, 0) << verb;
    EXPECT_THAT(help.out, ::testing::HasSubstr("Example:\n  strata " + verb));
    for (const char* common : {"--config", "--set", "--quiet", "--seed", "--threads"}) {
      EXPECT_THAT(help.out, ::testing::HasSubstr(common)) << verb;
    }
  }
}

TEST(Program, HelpSaysWhatEveryMapModelIs) {
  const std::string localize = run("localize --help").out;
  const std::string compare = run("compare --help").out;
  for (const auto& model : maps::map_models().all()) {
    const auto said = ::testing::HasSubstr(model->shown_name() + ": " + model->description);
    EXPECT_THAT(compare, said);
    if (!model->is_in_folder()) continue;
    EXPECT_THAT(localize, said);
  }
}

TEST(Program, MessagesWritesAPackageAndReplacesAnOlderOne) {
  const strata::test::TemporaryDirectory folder;
  const fs::path package = folder.path() / "src" / "strata_msgs";
  EXPECT_EQ(run("messages " + quoted(package) + " 2>&1").code, 0);
  std::ofstream(package / "msg" / "Gone.msg") << "int32 x\n";
  std::ofstream(package / "COLCON_IGNORE") << "";
  const Outcome outcome = run("messages " + quoted(package) + " 2>&1");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, ::testing::HasSubstr(": the package strata_msgs, "));
  EXPECT_THAT(test::bytes_of(package / "package.xml"),
              ::testing::HasSubstr("<version>" STRATA_VERSION "</version>"));
  EXPECT_THAT(test::bytes_of(package / "msg" / "LocalizationHealth.msg"),
              ::testing::HasSubstr("\nbool lost\n"));
  EXPECT_FALSE(fs::exists(package / "msg" / "Gone.msg"));
  EXPECT_TRUE(fs::exists(package / "COLCON_IGNORE")) << "what is not ours stays";
  EXPECT_EQ(run("messages --config a.yaml " + quoted(package) + " 2>/dev/null").code, 2);
}

TEST(Program, RunCheckListsWhatBecameOfNav2sParameters) {
  const strata::test::TemporaryDirectory folder;
  const fs::path file = folder.path() / "nav2_params.yaml";
  std::ofstream(file) << "amcl:\n  ros__parameters:\n    update_min_d: 0.3\n    sigma_hit: 0.2\n"
                         "    sigma_hitt: 0.2\n    laser_model_type: beam\n"
                         "map_server:\n  ros__parameters:\n    use_sim_time: True\n"
                         "    yaml_filename: \"\"\n    frame_id: floor\n"
                         "bt_navigator:\n  ros__parameters: {odom_topic: /odom}\n";
  std::ofstream(folder.path() / "room.pgm") << "P5\n2 2\n255\n" << std::string(4, '\xfe');
  std::ofstream(folder.path() / "room.yaml")
      << "image: room.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
         "occupied_thresh: 0.65\nfree_thresh: 0.25\n";
  const Outcome outcome =
      run("run --check '" STRATA_SOURCE_DIR "/components/config/nav2.yaml' --config " +
          quoted(file) + " --set map_server.map=" + quoted(folder.path() / "room.yaml") +
          " --set localizer.maps= --set localizer.model=occupancy" +
          " --set localizer.sensor.beam.mixture.hit_stddev_m=0.1 2>&1");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  const std::string place = file.string();
  using testing::HasSubstr;
  EXPECT_THAT(outcome.out, HasSubstr(place + ":3: update_min_d  is localizer.gating.translation_m: "
                                             "0.3\n"));
  EXPECT_THAT(outcome.out, HasSubstr(place + ":4: sigma_hit  would be "
                                             "sensor.beam.mixture.hit_stddev_m: 0.2, which is "
                                             "given otherwise\n"));
  EXPECT_THAT(outcome.out, HasSubstr(place + ":5: sigma_hitt  is unknown: did you mean"));
  EXPECT_THAT(outcome.out, HasSubstr("note: " + place + ":5: amcl has no parameter 'sigma_hitt'"));
  EXPECT_THAT(outcome.out, HasSubstr(place + ":10: yaml_filename  is left out: it is empty\n"));
  EXPECT_THAT(outcome.out, HasSubstr(place + ":11: frame_id  is map_frame: floor\n"));
  EXPECT_THAT(outcome.out, HasSubstr("for no component of the composition: bt_navigator\n"));
}

TEST(Program, BadInputEndsWithTwoAndSaysWhere) {
  const Outcome outcome = run("info /no/such/log 2>&1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.out, "strata info: error: /no/such/log: does not exist; check the path\n");
}

TEST(Program, KnowsPresetsAndTellsOfSettingsThatAreGone) {
  const Outcome unknown = run("learn /no/log --out /no/maps --set preset=paper-emm 2>&1");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.out,
            "strata learn: error: --set preset: preset 'paper-emm' sets nothing here; known "
            "presets are: paper-em, paper-patch, paper-timescale\n");
  const Outcome known = run("learn /no/log --out /no/maps --set preset=paper-em 2>&1");
  EXPECT_THAT(known.out, ::testing::HasSubstr("/no/log")) << "that is what is wrong";
  const Outcome gone =
      run("localize /no/log --maps /no/maps --out /no/out --initial-pose 0,0,0 "
          "--set sensor.states.reach_m=2 2>&1");
  EXPECT_THAT(gone.out, ::testing::HasSubstr("note: --set sensor.states.reach_m: "
                                             "sensor.states.reach_m is gone and is left out"));
}

TEST(Program, CtrlCEndsEvenAVerbThatIsStuck) {
  const strata::test::TemporaryDirectory folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  // Nobody writes into the pipe, so opening it never returns; `timeout` sends SIGINT after a second
  // and would report 137 had it to kill.
  const std::string command = "timeout --preserve-status --kill-after=60 --signal=INT 1 '" +
                              std::string(STRATA_PROGRAM) + "' info " + quoted(pipe) +
                              " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

TEST(Program, EvaluateAlignsBeforeItJudges) {
  const strata::test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "a.txt") << "1 0 0 0\n2 1 0 0\n3 2 1 0\n";
  std::ofstream(folder.path() / "b.txt") << "1 5 0 0\n2 6 0 0\n3 7 1 0\n";
  const Outcome outcome = run("evaluate --json " + quoted(folder.path() / "a.txt") + " --truth " +
                              quoted(folder.path() / "b.txt"));
  ASSERT_EQ(outcome.code, 0);
  const auto result = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(result["absolute"]["error_m"]["mean"].get<double>(), 5.0, 1e-9);
  EXPECT_NEAR(result["aligned"]["error_m"]["max"].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(run("evaluate " + quoted(folder.path() / "a.txt") + " 2>/dev/null").code, 2);
}

TEST(Program, EvaluateShiftsRelationsWithTheTruth) {
  const strata::test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "a.txt") << "1 0 0 0\n2 1 0 0\n3 2 1 0\n";
  std::ofstream(folder.path() / "r.txt") << "101 102 1 0 0 0 0 0\n102 103 1 1 0 0 0 0\n";
  const std::string command = "evaluate --json " + quoted(folder.path() / "a.txt") +
                              " --relations " + quoted(folder.path() / "r.txt");
  const Outcome shifted = run(command + " --truth-offset=-100");
  ASSERT_EQ(shifted.code, 0);
  const auto result = nlohmann::json::parse(shifted.out);
  EXPECT_EQ(result["relations"]["matched"], 2);
  EXPECT_NEAR(result["relations"]["error_m"]["max"].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(run(command + " 2>/dev/null").code, 2);
}

}  // namespace
}  // namespace strata::tools
