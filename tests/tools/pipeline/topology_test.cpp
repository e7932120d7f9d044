// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/topology.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/decoded_png.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"
#include "tools/pipeline/topology_files.hpp"

namespace strata::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string file_with(const std::string& text) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "strata_landmark_times.txt";
  std::ofstream(path) << text;
  return path.string();
}

TEST(LandmarkTimes, AreReadLineByLineAndBadOnesNamed) {
  EXPECT_THAT(read_landmark_times(file_with("# hall\n1.5\n\n 20 # door\n")),
              ElementsAre(1.5, 20.0));
  for (const char* text : {"1.0\nsoon\n", "1.0\n2.0 3.0\n", "1.0\nnan\n"}) {
    try {
      (void)read_landmark_times(file_with(text));
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(".txt:2"));
    }
  }
  EXPECT_THROW((void)read_landmark_times("/no/such/file"), InputError);
}

TEST(TopologyAgreement, CountsPairsByTheirTrueDistance) {
  TopologyMap map;
  std::vector<Observation> observations(5);
  const std::vector<std::optional<Pose2>> truths{Pose2{0, 0, 0}, Pose2{0.9, 0, 0}, Pose2{9, 0, 0},
                                                 Pose2{1.8, 0, 0}, Pose2{0, 1.7, 0}};
  for (int i = 0; i < 5; ++i) {
    observations[static_cast<std::size_t>(i)].scan.stamp = Stamp::from_seconds(i);
    topology::MadeVisit visit;
    visit.visit.stamp = Stamp::from_seconds(i);
    map.visits.push_back(visit);
  }
  topology::Hypothesis hypothesis;
  hypothesis.labels = {0, 0, 0, 0, 1};
  const TopologyAgreement counted = agreement(map, hypothesis, observations, truths, 1.0);
  EXPECT_EQ(counted.near, 2U);
  EXPECT_EQ(counted.near_merged, 2U);
  EXPECT_EQ(counted.between, 3U);          // 1.8 m along x, 1.7 and 1.92 m to the last one
  EXPECT_EQ(counted.between_merged, 1U);   // the first of these
  EXPECT_EQ(counted.between_chained, 1U);  // linked by the place halfway
  EXPECT_EQ(counted.far, 5U);
  EXPECT_EQ(counted.far_merged, 3U);
  EXPECT_EQ(counted.unclear, 0U);
}

TEST(TopologyAgreement, CountsPairsApartThatTheTruthCannotTell) {
  TopologyMap map;
  std::vector<Observation> observations(4);
  // 0.6 m, 1.05 m, 1.15 m and 1.65 m: with a truth good to 0.1 m the second may be within a metre.
  const std::vector<std::optional<Pose2>> truths{Pose2{0, 0, 0}, Pose2{0.6, 0, 0},
                                                 Pose2{1.65, 0, 0}, Pose2{1.75, 0, 0}};
  for (int i = 0; i < 4; ++i) {
    observations[static_cast<std::size_t>(i)].scan.stamp = Stamp::from_seconds(i);
    map.visits.emplace_back().visit.stamp = Stamp::from_seconds(i);
  }
  topology::Hypothesis hypothesis;
  hypothesis.labels = {0, 0, 0, 1};
  const TopologyAgreement sure = agreement(map, hypothesis, observations, truths, 1.0);
  EXPECT_EQ(sure.near, 2U);  // 0.6 m, and 0.1 m between the last two
  EXPECT_EQ(sure.between, 4U);
  EXPECT_EQ(sure.between_merged, 2U);
  EXPECT_EQ(sure.between_chained, 0U);
  const TopologyAgreement counted = agreement(map, hypothesis, observations, truths, 1.0, 0.1);
  EXPECT_EQ(counted.near, 2U);
  EXPECT_EQ(counted.near_merged, 1U);
  EXPECT_EQ(counted.unclear, 1U);
  EXPECT_EQ(counted.unclear_merged, 1U);
  EXPECT_EQ(counted.between, 3U);
  EXPECT_EQ(counted.between_merged, 1U);
  EXPECT_EQ(counted.between_chained, 3U);  // all, over the pair that may be within a metre
}

TEST(MapTopology, OfARunWithLandmarksByHandIsWholeAndTheSameAtAnyNumberOfThreads) {
  const Runs runs = test_room::simulate_runs(11, 1);
  const double end_s = elapsed_seconds(runs.observations).back();
  const std::vector<double> times_s{0.2 * end_s, 0.5 * end_s, 0.8 * end_s};
  const TopologyMap one = map_topology(runs.observations, {}, times_s, {}, 1, 1, nullptr);
  ASSERT_EQ(one.visits.size(), 3U);
  double sum = 0.0;
  for (const topology::Hypothesis& hypothesis : one.posterior) sum += hypothesis.probability;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_EQ(one.scans.size(), runs.observations.size());
  EXPECT_TRUE(one.optimized);
  const TopologyMap two = map_topology(runs.observations, {}, times_s, {}, 1, 2, nullptr);
  ASSERT_EQ(two.posterior.size(), one.posterior.size());
  EXPECT_EQ(two.posterior.front().poses, one.posterior.front().poses);
  for (std::size_t i = 0; i < one.scans.size(); ++i) {
    EXPECT_EQ(two.scans[i].map_from_robot, one.scans[i].map_from_robot);
  }
  const std::filesystem::path dir = std::filesystem::path(testing::TempDir()) / "strata_topology";
  std::filesystem::create_directories(dir);
  const nlohmann::json json = write_topology(dir, "room", one, {});
  EXPECT_EQ(json["visits"].size(), 3U);
  report::Drawings drawings;
  write_topology_pictures(dir, one, drawings);
  EXPECT_EQ(drawings.what_is_missing(), "");
  for (const char* name : {"topologies.json", "topology.graphml", "occupancy.yaml", "occupancy.pgm",
                           "trajectory.tum", "topologies.png", "landmarks.png", "map.png"}) {
    EXPECT_GT(std::filesystem::file_size(dir / name), 50U) << name;
  }
  const report::Image drawn = test::decode(test::bytes_of(dir / "landmarks.png"));
  const auto is_dark = [](const report::Color& c) { return c.r < 80 && c.g < 80 && c.b < 90; };
  EXPECT_GT(std::count_if(drawn.pixels().begin(), drawn.pixels().end(), is_dark), 1500)
      << "walls can be seen";
  std::filesystem::remove_all(dir);
}

TEST(MapTopology, RefusesALogWithoutTwoLandmarks) {
  const Runs runs = test_room::simulate_runs(11, 1);
  const std::vector<double> none;
  EXPECT_THROW((void)map_topology(runs.observations, {}, none, {}, 1, 1, nullptr), InputError);
}

}  // namespace
}  // namespace strata::pipeline
