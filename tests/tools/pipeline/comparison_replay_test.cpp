// SPDX-License-Identifier: Apache-2.0
/// What the page of a comparison tells of its models, and how its report leads there.
#include "tools/pipeline/comparison_replay.hpp"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/test_data.hpp"
#include "tools/pipeline/comparison_report.hpp"
#include "tools/pipeline/drive_replay.hpp"
#include "tools/pipeline/localize.hpp"

namespace strata::pipeline {
namespace {

constexpr std::size_t kScans = 4;
/// Of the first scan; seconds of this size are not to be told apart by a double to the nanosecond.
constexpr std::int64_t kBegin_ns = 1'790'000'000'123'456'789;
constexpr std::int64_t kStep_ns = 100'000'001;

/// Two models and a peer on one drive; the patch model has one area and tells of it in scans 1, 3.
struct Compared {
  Comparison comparison;
  maps::Maps maps;
  TestPart drive;

  Compared() {
    maps.filtered = ReflectionGrid{0.1, CellRect{{0, 0}, {20, 20}}};
    patch::PatchMap patches;
    patches.submaps.resize(1);
    patches.submaps[0].rect = CellRect{{2, 4}, {6, 12}};
    maps.patches = patches;
    for (std::size_t i = 0; i < kScans; ++i) {
      Observation observation;
      observation.scan.stamp = Stamp{kBegin_ns + static_cast<std::int64_t>(i) * kStep_ns};
      observation.scan.angle_increment_rad = 0.01F;
      observation.scan.range_max_m = 10.0F;
      observation.scan.ranges_m = {2.0F};
      drive.observations.push_back(observation);
      drive.truths.emplace_back(Pose2{static_cast<double>(i), 0.0, 0.0});
    }
    comparison.parts.resize(1);
    comparison.parts[0].scans = kScans;
    comparison.seeds = 2;
    for (const char* name : {"filtered", "patch", "peer_other"}) add_model(name);
    StateTrace trace;
    trace.submap = 0;
    for (const std::size_t scan : {1, 3}) {
      trace.time_s.push_back(since_begin_s(scan));
      // As after sums in another order: not the same double, the same nanosecond.
      trace.time_s.back() += 1e-10;
    }
    trace.probability = {{0.3, 0.9}, {0.7, 0.1}};
    comparison.models[1].states = {trace};
  }

  [[nodiscard]] double since_begin_s(std::size_t scan) const {
    return (drive.observations[scan].scan.stamp - drive.observations[0].scan.stamp).seconds();
  }

  /// With runs of two seeds, the second 5 m off.
  void add_model(const std::string& name) {
    ModelResult model;
    model.model = name;
    for (const double off_m : {0.1, 5.0}) {
      ModelRun run;
      for (const auto& truth : drive.truths) {
        run.estimates.push_back(Pose2{truth->x + off_m, truth->y, 0.0});
      }
      model.runs.push_back(run);
    }
    comparison.models.push_back(std::move(model));
  }

  [[nodiscard]] nlohmann::json data() const {
    const test::TemporaryDirectory folder;
    write_comparison_replay(comparison, maps, drive, folder.path());
    const std::string page = test::bytes_of(folder.path() / kReplayPage);
    const std::string head = "<script id=\"drive\" type=\"application/json\">";
    const std::size_t at = page.find(head) + head.size();
    return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
  }
};

TEST(ComparisonReplay, HasATrackOfEachModelsFirstRun) {
  const nlohmann::json data = Compared().data();
  ASSERT_EQ(data["tracks"].size(), 3U);
  EXPECT_EQ(data["tracks"][0]["name"], "filtered");
  EXPECT_EQ(data["tracks"][1]["name"], "patch");
  EXPECT_EQ(data["tracks"][2]["name"], "peer_other") << "no model of ours";
  for (const auto& track : data["tracks"]) {
    ASSERT_EQ(track["poses"].size(), kScans);
    EXPECT_EQ(track["poses"][2], nlohmann::json({2100, 0, 0}));
  }
  EXPECT_EQ(data["truths"][3], nlohmann::json({3000, 0, 0}));
  EXPECT_EQ(data["times"], nlohmann::json({0, 100, 200, 300}));
}

TEST(ComparisonReplay, HasAreasAndStatesOnlyOfModelsThatHaveThem) {
  const nlohmann::json data = Compared().data();
  EXPECT_EQ(data["tracks"][0]["areas"], nlohmann::json::array());
  EXPECT_EQ(data["tracks"][2]["areas"], nlohmann::json::array());
  ASSERT_EQ(data["tracks"][1]["areas"].size(), 1U);
  EXPECT_NEAR(data["tracks"][1]["areas"][0][3].get<double>(), 1.2, 1e-9);
  const nlohmann::json states = data["tracks"][1]["states"];
  ASSERT_EQ(states.size(), kScans);
  EXPECT_EQ(states[0], nlohmann::json::array());
  EXPECT_EQ(states[1], nlohmann::json::parse("[[0, 1, 70]]"));
  EXPECT_EQ(states[2], nlohmann::json::array());
  EXPECT_EQ(states[3], nlohmann::json::parse("[[0, 0, 90]]"));
  EXPECT_EQ(data["tracks"][0]["states"][1], nlohmann::json::array());
}

TEST(ComparisonReplay, HasTheParticlesOfTheFirstRun) {
  Compared compared;
  compared.comparison.models[1].runs[0].shown_particles.assign(2 * kShownParticles * kScans, 0.1F);
  const nlohmann::json data = compared.data();
  ASSERT_EQ(data["tracks"][1]["particles"].size(), kScans);
  EXPECT_EQ(data["tracks"][1]["particles"][2][0], -200) << "it is at (2.1, 0)";
  EXPECT_EQ(data["tracks"][0]["particles"], nlohmann::json::array()) << "of whom none are known";
}

TEST(ComparisonReplay, GoesOnAfterAStateOfNoScan) {
  Compared compared;
  StateTrace& trace = compared.comparison.models[1].states[0];
  trace.time_s[0] += 0.05;  // between scans 1 and 2
  const nlohmann::json states = compared.data()["tracks"][1]["states"];
  EXPECT_EQ(states[1], nlohmann::json::array());
  EXPECT_EQ(states[2], nlohmann::json::array());
  EXPECT_EQ(states[3], nlohmann::json::parse("[[0, 0, 90]]"));
}

TEST(ComparisonReplay, LeavesOutModelsWithoutAPoseForEachScanOfTheDrive) {
  Compared compared;
  compared.comparison.models[0].runs[0].estimates.pop_back();
  compared.comparison.models[2].runs[0].part = 1;
  const nlohmann::json data = compared.data();
  ASSERT_EQ(data["tracks"].size(), 1U);
  EXPECT_EQ(data["tracks"][0]["name"], "patch");
}

TEST(ComparisonReplay, IsLinkedFromTheReportWhereItIs) {
  const Compared compared;
  const test::TemporaryDirectory folder;
  const std::string link = "href=\"replay.html\"";
  write_report(compared.comparison, {}, "", folder.path());
  EXPECT_EQ(test::bytes_of(folder.path() / "report.html").find(link), std::string::npos);
  write_comparison_replay(compared.comparison, compared.maps, compared.drive, folder.path());
  write_report(compared.comparison, {}, "", folder.path());
  EXPECT_NE(test::bytes_of(folder.path() / "report.html").find(link), std::string::npos);
}

}  // namespace
}  // namespace strata::pipeline
