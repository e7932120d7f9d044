// SPDX-License-Identifier: Apache-2.0
/// What the page of a drive holds: within its budget, whatever the drive.
#include "tools/pipeline/drive_replay.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "tools/pipeline/localize.hpp"

namespace strata::pipeline {
namespace {

struct Drive {
  ReflectionGrid map{0.1, CellRect{{0, 0}, {20, 20}}};
  std::vector<Observation> observations;
  std::vector<log::StampedPose> trajectory;
  std::vector<maps::StateRow> states;
  std::vector<double> scores;
  std::vector<std::optional<Pose2>> truths;
};

Drive drive_of(std::size_t scans, std::size_t beams) {
  Drive drive;
  for (std::size_t i = 0; i < scans; ++i) {
    Observation observation;
    observation.scan.stamp = Stamp::from_seconds(100.0 + 0.1 * static_cast<double>(i));
    observation.scan.angle_increment_rad = 0.01F;
    observation.scan.range_max_m = 10.0F;
    observation.scan.ranges_m.assign(beams, 2.0F);
    observation.scan.robot_from_laser = Pose2{0.5, 0.0, 0.0};
    drive.trajectory.push_back(
        {observation.scan.stamp, Pose2{0.001 * static_cast<double>(i), 1, 0}});
    drive.scores.push_back(0.75);
    drive.truths.emplace_back(Pose2{0.0, 1.0, 0.0});
    drive.observations.push_back(observation);
  }
  return drive;
}

std::string page_of(const Drive& drive, const std::string& name = "patch",
                    std::size_t budget = kReplayBudget) {
  return replay_page({drive.map,
                      drive.observations,
                      drive.truths,
                      {{name, drive.trajectory, drive.states, drive.scores}}},
                     budget);
}

nlohmann::json data_of(const std::string& page) {
  const std::string head = "<script id=\"drive\" type=\"application/json\">";
  const std::size_t at = page.find(head) + head.size();
  return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
}

TEST(DriveReplay, TellsOfEveryScanInWholeUnits) {
  const auto data = data_of(page_of(drive_of(3, 1)));
  EXPECT_EQ(data["times"], nlohmann::json({0, 100, 200}));
  EXPECT_EQ(data["beams"][0], nlohmann::json({250, 0})) << "in the robot's frame";
  EXPECT_EQ(data["tracks"][0]["poses"][2], nlohmann::json({2, 1000, 0}));
  EXPECT_EQ(data["tracks"][0]["scores"][0], 75);
  EXPECT_EQ(data["truths"][1], nlohmann::json({0, 1000, 0}));
}

TEST(DriveReplay, TellsTheLikeliestStateOfEachArea) {
  Drive drive = drive_of(3, 1);
  const auto stamp = drive.observations[1].scan.stamp;
  drive.states = {{stamp, 4, 0, 0.2}, {stamp, 4, 1, 0.8}, {stamp, 2, 0, 1.0}};
  const auto states = data_of(page_of(drive))["tracks"][0]["states"];
  EXPECT_EQ(states[0], nlohmann::json::array());
  EXPECT_EQ(states[1], nlohmann::json({{4, 1, 80}, {2, 0, 100}}));
  EXPECT_EQ(states[2], nlohmann::json::array());
}

TEST(DriveReplay, TellsOfParticlesFromThePoseAndLeavesOutWhatIsNoNumber) {
  const Drive drive = drive_of(3, 1);  // at (0, 1), (0.001, 1), (0.002, 1)
  std::vector<float> particles(2 * kShownParticles * 3, 1.0F);
  particles[2 * kShownParticles] = std::numeric_limits<float>::quiet_NaN();
  particles[2 * kShownParticles + 3] = 1.25F;
  const auto data =
      data_of(replay_page({drive.map,
                           drive.observations,
                           drive.truths,
                           {{"patch", drive.trajectory, {}, {}, nullptr, particles}}}));
  const auto shown = data["tracks"][0]["particles"];
  ASSERT_EQ(shown.size(), 3U);
  EXPECT_EQ(shown[0].size(), 2 * kShownParticles);
  EXPECT_EQ(shown[0][0], 100) << "[cm]";
  EXPECT_EQ(shown[0][1], 0);
  EXPECT_EQ(shown[1].size(), 2 * kShownParticles - 2) << "one is nowhere";
  EXPECT_EQ(shown[1][1], 25);
  EXPECT_EQ(data_of(page_of(drive))["tracks"][0]["particles"], nlohmann::json::array());
}

TEST(ShownParticles, AreThoseThatWeigh) {
  localization::ParticleSet set;
  set.resize(4);
  set.x_m = {0.0, 1.0, 2.0, 3.0};
  set.y_m = {0.0, 0.0, 0.0, 0.0};
  set.weight = {0.25, 0.0, 0.75, 0.0};
  std::vector<float> shown;
  show_particles(set, shown);
  ASSERT_EQ(shown.size(), 2 * kShownParticles);
  std::size_t first = 0;
  std::size_t third = 0;
  for (std::size_t k = 0; k < kShownParticles; ++k) {
    first += shown[2 * k] == 0.0F ? 1 : 0;
    third += shown[2 * k] == 2.0F ? 1 : 0;
  }
  EXPECT_EQ(first, kShownParticles / 4);
  EXPECT_EQ(third, kShownParticles - first);
  set.weight = {0.0, 0.0, 0.0, 0.0};
  show_particles(set, shown);
  ASSERT_EQ(shown.size(), 4 * kShownParticles);
  EXPECT_FALSE(std::isfinite(shown.back()));
}

TEST(DriveReplay, LeavesOutScansAndBeamsOfALongDrive) {
  const std::string page = page_of(drive_of(4000, 1080));
  const auto data = data_of(page);
  EXPECT_LE(page.size(), kReplayBudget);
  EXPECT_EQ(data["step"], 3);
  EXPECT_EQ(data["times"].size(), 1334U);
  EXPECT_EQ(data["tracks"][0]["poses"].size(), 1334U);
  EXPECT_LE(data["beams"][0].size(), 2 * kReplayBeams);
}

TEST(DriveReplay, KeepsToItsBudgetOrSaysThatItCannot) {
  const Drive drive = drive_of(400, 90);
  const std::string page = page_of(drive, "patch", 150'000);
  EXPECT_LE(page.size(), 150'000U);
  EXPECT_GT(data_of(page)["step"], 1);
  EXPECT_THROW((void)page_of(drive, "patch", 1000), OutputError);
}

TEST(DriveReplay, HoldsWhatIsNotANumberForUnknown) {
  Drive drive = drive_of(2, 2);
  drive.observations[0].scan.ranges_m[0] = std::numeric_limits<float>::quiet_NaN();
  drive.truths[0] = Pose2{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};
  const auto data = data_of(page_of(drive));
  EXPECT_EQ(data["beams"][0].size(), 2U);
  EXPECT_TRUE(data["truths"][0].is_null());
}

TEST(DriveReplay, HasNamesThatCannotEndItsData) {
  const std::string name = "</script><script>alert(1)";
  const std::string page = page_of(drive_of(2, 1), name);
  EXPECT_EQ(page.find("alert(1)</"), std::string::npos);
  EXPECT_EQ(data_of(page)["tracks"][0]["name"], name);
}

TEST(DriveReplay, OfNoScansIsAPage) {
  EXPECT_EQ(data_of(page_of(drive_of(0, 0)))["times"].size(), 0U);
}

}  // namespace
}  // namespace strata::pipeline
