// SPDX-License-Identifier: Apache-2.0
/// The gate lets good maps through and none that would harm a robot.
#include "tools/site/gate.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/carmen.hpp"
#include "components/log/trajectory_file.hpp"
#include "components/maps/maps_folder.hpp"
#include "memory/store/store.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/simulate/two_days.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/site/gate_report.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kDay_s = 86'400.0;

/// The maps of a simulated room, and a recording of the day after.
class Gate : public testing::Test {
 protected:
  [[nodiscard]] static const test::TwoDays& days() {
    static const test::TwoDays made = test::two_days(STRATA_SCENARIO_DIR "/empty_room.yaml", 1);
    return made;
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }

  /// Maps of the first day, in a frame that lies at `moved` in the true one.
  void learn(const std::string& name, const Pose2& moved, bool consistent = true,
             double obstacles = 0.0) const {
    std::vector<std::optional<Pose2>> poses;
    for (const auto& pose : days().first_poses) poses.emplace_back(moved * *pose);
    pipeline::LearnResult learned = pipeline::learn(days().first, poses, {}, {}, 1, 1, nullptr);
    ReflectionGrid& map = learned.slam.filtered;
    // Every so many cells something that is not there.
    const auto step = obstacles > 0.0 ? static_cast<std::size_t>(1.0 / obstacles) : map.size();
    for (std::size_t i = step; i < map.size(); i += step) {
      if (is_free(map.values()[i])) map.values()[i] = 1.0F;
    }
    maps::write_grid_maps(at(name), learned.slam);
    std::ofstream(at(name) / maps::kSummaryFile)
        << nlohmann::json{{"kind", "maps"},
                          {"consistency",
                           {{"consistent", consistent},
                            {"places", {{{"x", 1.0}, {"y", 2.0}, {"why", "seen twice"}}}}}}};
  }

  void write_log(const std::string& name, const std::vector<Observation>& observations) const {
    log::LogContent content;
    content.observations = observations;
    log::write_carmen(at(name), content);
  }

  [[nodiscard]] GateReport run(const std::string& candidate, bool with_log = true) const {
    GateTask task;
    task.candidate = at(candidate);
    task.active = at("active");
    if (with_log) {
      write_log("tuesday.clf", days().second);
      task.input.logs = {at("tuesday.clf").string()};
    }
    return run_gate(task, {}, nullptr);
  }

  [[nodiscard]] static std::vector<std::string> failed(const GateReport& report) {
    std::vector<std::string> names;
    for (const GateCheck& check : report.checks) {
      if (!check.passed) names.push_back(check.name);
    }
    return names;
  }
  test::TemporaryDirectory folder_;
};

TEST(GateStart, IsWhereOnePlaceIsSureOrWhereNoneEverIsTheLikeliest) {
  std::vector<double> scores(40, 0.4);
  std::vector<double> alone(40, 0.3);
  EXPECT_EQ(found_at(scores, alone), std::nullopt);
  std::fill(alone.begin() + 5, alone.end(), 0.9);
  EXPECT_EQ(found_at(scores, alone), 5U) << "several places fit to the end";
  std::fill(scores.begin() + 31, scores.end(), 0.9);
  EXPECT_EQ(found_at(scores, alone), 5U) << "nine scans are no drive";
  scores[30] = 0.9;
  EXPECT_EQ(found_at(scores, alone), 30U);
  EXPECT_EQ(found_at({}, {}), std::nullopt);
}

TEST_F(Gate, LetsMapsThroughThatAreAsGoodAndDrivesThem) {
  learn("active", {});
  learn("same", {});
  const GateReport report = run("same");
  EXPECT_THAT(failed(report), IsEmpty()) << to_text(report);
  ASSERT_EQ(report.logs.size(), 1U);
  EXPECT_EQ(report.logs[0].passed_over, "");
  EXPECT_GT(report.logs[0].candidate.explained, 0.9);
}

TEST_F(Gate, RefusesAFrameThatMoved) {
  learn("active", {});
  learn("moved", Pose2{0.06, 0.03, 0.0});
  // Half a cell at the walls of this small room: less is not to be seen in its grid.
  learn("turned", Pose2{0.0, 0.0, 0.015});
  EXPECT_THAT(failed(run("moved", false)), Contains("frame"));
  EXPECT_THAT(failed(run("turned", false)), Contains("frame"));
  EXPECT_NEAR(run("moved", false).shift->shift_m, 0.067, 0.015);
}

TEST_F(Gate, RefusesSmallStepsThatAddUp) {
  learn("first", {});
  learn("active", Pose2{0.02, 0.0, 0.0});
  learn("next", Pose2{0.04, 0.0, 0.0});
  learn("back", Pose2{0.01, 0.0, 0.0});
  GateTask task;
  task.active = at("active");
  task.candidate = at("next");
  EXPECT_THAT(failed(run_gate(task, {}, nullptr)), IsEmpty()) << "no step is too large";
  task.earlier = {at("first"), at("active")};
  const GateReport report = run_gate(task, {}, nullptr);
  EXPECT_THAT(failed(report), testing::ElementsAre("drift")) << to_text(report);
  EXPECT_NEAR(report.drift->shift_m, 0.04, 0.01);
  task.candidate = at("back");
  EXPECT_THAT(failed(run_gate(task, {}, nullptr)), IsEmpty());
}

TEST_F(Gate, HoldsTheFrameAgainstTheFirstVersionThatStillHasTheWalls) {
  learn("active", {});
  learn("rebuilt", Pose2{5.0, 4.0, 0.8});  // as good as another building
  learn("moved", Pose2{0.05, 0.0, 0.0});
  GateTask task;
  task.candidate = at("moved");
  task.earlier = {at("rebuilt"), at("active")};
  const GateReport report = run_gate(task, {}, nullptr);
  EXPECT_THAT(failed(report), testing::ElementsAre("drift")) << to_text(report);
  EXPECT_NEAR(report.drift->shift_m, 0.05, 0.01);
}

TEST_F(Gate, RefusesAMapThatIsFoldedAndSaysWhere) {
  learn("active", {});
  learn("folded", {}, false);
  const GateReport report = run("folded", false);
  EXPECT_THAT(failed(report), Contains("fold"));
  EXPECT_THAT(in_short(report), HasSubstr("at (1.0, 2.0): seen twice"));
}

TEST_F(Gate, RefusesAMapInWhichRobotsDoWorse) {
  learn("active", {});
  learn("cluttered", {}, true, 0.01);
  const GateReport report = run("cluttered");
  EXPECT_FALSE(report.passed()) << to_text(report);
  EXPECT_THAT(failed(report), testing::AnyOf(Contains("contradictions"), Contains("fit"),
                                             Contains("score"), Contains("losses")));
}

/// The second day was put where it was not.
TEST_F(Gate, RefusesANewRunThatContradictsWhatIsActiveUnlessARecordingDoesAsWell) {
  learn("active", {});
  learn("astray", {});
  std::vector<PosedScan> scans;
  std::vector<Observation> changed = days().second;
  for (std::size_t i = 0; i < days().second.size(); ++i) {
    const Pose2 pose = Pose2{1.2, 0.7, 0.5} * days().second_poses[i];
    scans.push_back({.run = 1,
                     .scan = days().second[i].scan,
                     .map_from_robot = pose,
                     .static_probability = {}});
    for (float& range_m : changed[i].scan.ranges_m) range_m *= 0.5F;
    changed[i].scan.stamp = changed[i].scan.stamp + Duration::from_seconds(kDay_s);
  }
  memory::Store(at("astray") / maps::kStoreFile).save_scans(1, scans);
  const GateReport report = run("astray");
  EXPECT_THAT(failed(report), testing::ElementsAre("new run")) << to_text(report);
  EXPECT_THAT(in_short(report), HasSubstr("and no recording of another drive does as much"));
  EXPECT_THAT(failed(run("astray", false)), testing::ElementsAre("new run"));

  const auto beside = [&](const std::vector<Observation>& recording) {
    GateTask task;
    task.candidate = at("astray");
    task.active = at("active");
    write_log("changed.clf", recording);
    std::vector<log::StampedPose> truth;
    for (std::size_t i = 0; i < recording.size(); ++i) {
      truth.push_back({recording[i].scan.stamp, days().second_poses[i]});
    }
    log::write_trajectory(at("truth.tum"), truth);
    task.input.logs = {at("changed.clf").string()};
    task.input.truths = {at("truth.tum").string()};
    return run_gate(task, {}, nullptr);
  };
  // A day on which everything stood half as far away.
  const GateReport rebuilt = beside(changed);
  EXPECT_THAT(failed(rebuilt), testing::Not(Contains("new run"))) << to_text(rebuilt);
  // The run's own drive says nothing more than the run.
  std::vector<Observation> own = changed;
  for (std::size_t i = 0; i < own.size(); ++i) own[i].scan.stamp = days().second[i].scan.stamp;
  EXPECT_THAT(failed(beside(own)), Contains("new run"));
  // Somebody else's, half of which contradicts.
  std::vector<Observation> half = changed;
  for (std::size_t i = 0; i < 2 * half.size() / 5; ++i) {
    half[i].scan.ranges_m = days().second[i].scan.ranges_m;
  }
  const GateReport somewhat = beside(half);
  EXPECT_GT(somewhat.logs.front().active->contradicted, 0.5) << to_text(somewhat);
  EXPECT_THAT(failed(somewhat), Contains("new run"));
}

TEST_F(Gate, RefusesWhatNoRecordingSaysAnythingOf) {
  learn("active", {});
  learn("same", {});
  GateTask task;
  task.candidate = at("same");
  task.active = at("active");
  task.input.logs = {at("short.clf").string()};
  for (const int scans : {1, 9, 10}) {
    const std::vector<Observation> few(days().second.begin(), days().second.begin() + scans);
    write_log("short.clf", few);
    const GateReport report = run_gate(task, {}, nullptr);
    EXPECT_EQ(report.passed(), scans >= 10) << to_text(report);
    ASSERT_EQ(report.logs.size(), 1U);
    EXPECT_EQ(report.logs.front().passed_over.empty(), scans >= 10);
  }
}

TEST_F(Gate, WritesAReportWithPictures) {
  learn("active", {});
  learn("moved", Pose2{0.1, 0.0, 0.0});
  GateTask task;
  task.candidate = at("moved");
  task.active = at("active");
  const GateReport report = run_gate(task, {}, nullptr);
  fs::create_directories(at("out"));
  write_gate_report(at("out"), "Version 2", task, report);
  EXPECT_THAT(test::bytes_of(at("out/report.html")), HasSubstr("Refused"));
  const nlohmann::json check = nlohmann::json::parse(test::bytes_of(at("out/check.json")));
  EXPECT_FALSE(check["passed"].get<bool>());
  bool has_picture = false;
  for (const auto& entry : fs::directory_iterator(at("out"))) {
    has_picture = has_picture || entry.path().extension() == ".png";
  }
  EXPECT_TRUE(has_picture);
}

}  // namespace
}  // namespace strata::site
