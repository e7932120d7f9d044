// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/place_patches.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"
#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/comparison_report.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::pipeline {
namespace {

/// A hall of three doors, a run a day, at the true poses.
Runs hall(int days) {
  simulate::ScenarioConfig scenario =
      simulate::load_scenario(std::string(STRATA_SCENARIO_DIR) + "/three_doors.yaml");
  scenario.days = days;
  Runs runs;
  for (const simulate::SimulatedDay& day : simulate::simulate(scenario, 3).days) {
    for (const simulate::SimulatedScan& scan : day.scans) {
      runs.observations.push_back(scan.observation);
      runs.poses.emplace_back(scan.map_from_robot);
      runs.truths.emplace_back(std::nullopt);
    }
  }
  return runs;
}

std::vector<Eigen::Vector2d> places_of(const Runs& runs) {
  std::vector<PosedScan> scans;
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    const Observation& observation = runs.observations[i];
    scans.push_back({observation.run, observation.scan, *runs.poses[i], {}});
  }
  const std::vector<double> places = topology_places(scans, {}, 1, 2, nullptr);
  std::vector<Eigen::Vector2d> points_m;
  for (std::size_t i = 0; i + 1 < places.size(); i += 2) {
    points_m.emplace_back(places[i], places[i + 1]);
  }
  return points_m;
}

std::size_t nearest(const std::vector<Eigen::Vector2d>& points_m, const Eigen::Vector2d& to_m) {
  const auto found = std::min_element(
      points_m.begin(), points_m.end(),
      [&](const auto& a, const auto& b) { return (a - to_m).norm() < (b - to_m).norm(); });
  return static_cast<std::size_t>(found - points_m.begin());
}

TEST(TopologyPlaces, OfSeveralDaysAreThoseOfOneDayInTheMapFrame) {
  const std::vector<Eigen::Vector2d> one = places_of(hall(1));
  const std::vector<Eigen::Vector2d> three = places_of(hall(3));
  ASSERT_GE(one.size(), 2U);
  for (const Eigen::Vector2d& place_m : one) {
    EXPECT_LT((three[nearest(three, place_m)] - place_m).norm(), 1.0) << place_m.transpose();
    EXPECT_TRUE(place_m.x() > 0.0 && place_m.x() < 18.0 && place_m.y() > 0.0 && place_m.y() < 8.0);
  }
  // Every day would have its own places if the runs were not joined in one frame.
  for (std::size_t b = 0; b < three.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) EXPECT_GT((three[a] - three[b]).norm(), 0.5);
  }
}

TEST(ComparePatchPlaces, HasASubmapAPlaceThatChangesAndItsOwnErrors) {
  const Runs runs = hall(3);
  CompareConfig config;
  config.protocol.models = {"patch", "patch_places"};
  config.protocol.memory_steps = 1;
  config.protocol.memory_seeds = 1;
  config.localizer.kld.max_particles = 300;
  CompareJob job;
  job.log = "hall";
  job.splits = {split_by_run(runs, {"one", "two", "three"}, 2)};
  job.seeds = {1};
  job.threads = job.jobs = 2;
  const CompareOutcome outcome = compare(runs, config, job);

  ASSERT_TRUE(outcome.learned.place_patches);
  const patch::PatchMap& by_places = *outcome.learned.place_patches;
  ASSERT_FALSE(by_places.submaps.empty());
  std::vector<Eigen::Vector2d> places_m;
  for (std::size_t i = 0; i + 1 < outcome.learned.places.size(); i += 2) {
    places_m.emplace_back(outcome.learned.places[i], outcome.learned.places[i + 1]);
  }
  ASSERT_GE(places_m.size(), 2U);
  std::set<std::size_t> taken;
  for (const patch::Submap& submap : by_places.submaps) {
    const Eigen::Vector2d middle_m = 0.5 * by_places.base.resolution_m() *
                                     Eigen::Vector2d(submap.rect.min.x + submap.rect.max.x,
                                                     submap.rect.min.y + submap.rect.max.y);
    EXPECT_TRUE(taken.insert(nearest(places_m, middle_m)).second) << "two sub-maps of one place";
  }

  // With one place for all, what changes anywhere is one sub-map.
  EXPECT_GT(outcome.learned.patches.submaps.size(), 1U);
  EXPECT_EQ(learn_place_patches(outcome.learned.slam, {9.0, 4.0}, config.learn.patch, 1, nullptr)
                .submaps.size(),
            1U);

  const Comparison& comparison = outcome.comparison;
  ASSERT_EQ(comparison.models.size(), 2U);
  const ModelResult& result = comparison.models[1];
  EXPECT_EQ(result.model, "patch_places");
  ASSERT_EQ(result.runs.size(), 1U);
  EXPECT_LT(mean_error_m(result), 0.3);
  EXPECT_EQ(result.memory.size(), 2U);
  EXPECT_LT(result.memory[1].bytes, result.memory[0].bytes);

  const test::TemporaryDirectory dir;
  write_report(outcome, "", dir.path());
  EXPECT_TRUE(std::filesystem::exists(dir.path() / "places_patch_map.png"));
}

TEST(ComparePatchPlaces, LearnsNoPlacesUnlessTheModelIsAsked) {
  const Runs runs = hall(2);
  CompareConfig config;
  config.protocol.models = {"patch"};
  config.protocol.memory_steps = 0;
  CompareJob job;
  job.splits = {split_by_run(runs, {"one", "two"}, 1)};
  job.seeds = {1};
  const CompareOutcome outcome = compare(runs, config, job);
  EXPECT_FALSE(outcome.learned.place_patches);
  EXPECT_TRUE(outcome.learned.places.empty());
}

}  // namespace
}  // namespace strata::pipeline
