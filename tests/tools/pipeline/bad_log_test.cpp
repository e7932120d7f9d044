// SPDX-License-Identifier: Apache-2.0
/// Logs with scans that should not be: what is wrong is left out and counted, the rest is learned
/// and localized in as if it had not been there.
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/same_bits.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/localize.hpp"

namespace strata::pipeline {
namespace {

using strata::test::same_bits;

constexpr std::uint64_t kSeed = 5;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Every second beam, as when a driver is started again with another resolution.
void halve_beams(Scan& scan) {
  std::vector<float> kept;
  for (std::size_t i = 0; i < scan.size(); i += 2) kept.push_back(scan.ranges_m[i]);
  scan.ranges_m = kept;
  scan.angle_increment_rad *= 2.0F;
}

/// From the middle of the log on there are half as many beams.
Runs with_fewer_beams(Runs runs) {
  for (std::size_t i = runs.observations.size() / 2; i < runs.observations.size(); ++i) {
    halve_beams(runs.observations[i].scan);
  }
  return runs;
}

/// Some scans are followed by one of NaNs, one of no beam at all, and one that only says that
/// everything is too close, as a covered scanner does. Returns how many of each were put in.
std::size_t add_bad_scans(Runs& runs) {
  Runs damaged;
  std::size_t added = 0;
  const auto keep = [&](const Observation& observation, const std::optional<Pose2>& truth) {
    damaged.observations.push_back(observation);
    damaged.truths.push_back(truth);
    damaged.poses.emplace_back(std::nullopt);
  };
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    const Observation& observation = runs.observations[i];
    keep(observation, runs.truths[i]);
    if (i % 5 != 2) continue;
    std::vector<Observation> bad(3, observation);
    bad[0].scan.ranges_m.assign(observation.scan.size(), kNan);
    bad[1].scan.ranges_m.clear();
    bad[2].scan.ranges_m.assign(observation.scan.size(), i % 2 == 0 ? -1.0F : -kInf);
    for (const Observation& one : bad) keep(one, runs.truths[i]);
    ++added;
  }
  runs = damaged;
  return added;
}

struct LearnedDay {
  LearnResult result;
  maps::Maps maps;
};

LearnedDay learn_day(const std::vector<Observation>& log) {
  LearnedDay learned{learn(log, {}, {}, {}, kSeed, 2, nullptr), {}};
  learned.maps.occupancy = learned.result.slam.occupancy;
  learned.maps.filtered = learned.result.slam.filtered;
  learned.maps.patches = learned.result.patches;
  learned.maps.timescale = learned.result.timescale;
  return learned;
}

LocalizationRun localize_in(const LearnedDay& learned, const std::string& model, const Runs& runs) {
  // Relative to the first scan, as the map is.
  std::vector<std::optional<Pose2>> truths;
  for (const auto& truth : runs.truths) truths.emplace_back(between(*runs.truths.front(), *truth));
  const Pose2 map_from_first = learned.result.slam.scans.front().map_from_robot;
  for (auto& truth : truths) truth = map_from_first * *truth;
  Pose2Gaussian start;
  start.mean = *truths.front();
  start.covariance = Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal();
  return localize(runs.observations, truths, maps::make_map_model(learned.maps, model, {}),
                  learned.maps.filtered, {}, {start}, kSeed, 2, nullptr);
}

TEST(BadLog, WhatSaysNothingLeavesNoTraceAndTheRestIsLearned) {
  Runs runs = with_fewer_beams(test_room::simulate_runs(kSeed, 1));
  const std::size_t good = runs.observations.size();
  const LearnedDay clean = learn_day(runs.observations);
  EXPECT_EQ(clean.result.slam.skipped_scans, 0U);
  const std::size_t bad = add_bad_scans(runs);
  ASSERT_GT(bad, 5U);
  const LearnedDay learned = learn_day(runs.observations);
  EXPECT_EQ(learned.result.slam.skipped_scans, 2 * bad);
  // A covered scanner still moves with the robot, so those scans have a pose.
  ASSERT_EQ(learned.result.slam.scans.size(), good + bad);
  EXPECT_TRUE(same_bits(learned.result.slam.occupancy, clean.result.slam.occupancy));
  for (const char* model : {"occupancy", "filtered", "patch", "timescale"}) {
    SCOPED_TRACE(model);
    const LocalizationRun run = localize_in(learned, model, runs);
    EXPECT_EQ(run.unusable_scans, 3 * bad);
    ASSERT_EQ(run.errors.size(), runs.observations.size());
    EXPECT_LT(evaluate_run(run.errors).error_m.mean, 0.3);
  }
}

TEST(BadLog, ReadingsThatCannotBeAmongGoodOnesAreLeftOut) {
  Runs runs = test_room::simulate_runs(kSeed, 1);
  const float broken[] = {kNan, -3.0F, -kInf, 1e30F};
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    auto& ranges = runs.observations[i].scan.ranges_m;
    for (std::size_t b = i % 7; b < ranges.size(); b += 7) ranges[b] = broken[(b + i) % 4];
  }
  const LearnedDay learned = learn_day(runs.observations);
  EXPECT_EQ(learned.result.slam.skipped_scans, 0U);
  EXPECT_LT(learned.maps.filtered.size(), 1'000'000U);  // no beam of 1e30 m grew the map
  for (const char* model : {"occupancy", "filtered", "patch", "timescale"}) {
    SCOPED_TRACE(model);
    EXPECT_LT(evaluate_run(localize_in(learned, model, runs).errors).error_m.mean, 0.3);
  }
}

TEST(BadLog, OdometryThatIsMissingOrNoNumberIsBridged) {
  const Runs clean = test_room::simulate_runs(kSeed, 1);
  const LearnedDay learned = learn_day(clean.observations);
  for (const bool is_missing : {true, false}) {
    SCOPED_TRACE(is_missing);
    Runs runs = clean;
    for (std::size_t i = 10; i < runs.observations.size(); ++i) {
      if (i % 10 >= 3) continue;
      runs.observations[i].has_odometry = !is_missing;
      runs.observations[i].odom_from_robot.x = std::numeric_limits<double>::quiet_NaN();
    }
    const LocalizationRun run = localize_in(learned, "filtered", runs);
    ASSERT_EQ(run.trajectory.size(), runs.observations.size());
    EXPECT_LT(evaluate_run(run.errors).error_m.mean, 0.2);
    const LearnResult again = learn(runs.observations, {}, {}, {}, kSeed, 2, nullptr);
    for (const PosedScan& scan : again.slam.scans) ASSERT_TRUE(is_finite(scan.map_from_robot));
    EXPECT_GT(again.slam.scans.size(), runs.observations.size() / 2);
  }
}

TEST(BadLog, ScansFromThePastAreCountedAndLoseNothingOfWhatWasLearned) {
  const Runs runs = test_room::simulate_runs(kSeed, 1);
  std::vector<Observation> log = runs.observations;
  const LearnResult clean = learn(log, {}, {}, {}, kSeed, 2, nullptr);
  const std::vector<Observation> past(log.begin(), log.begin() + 10);
  log.insert(log.begin() + 20, past.begin(), past.end());
  const LearnResult result = learn(log, {}, {}, {}, kSeed, 2, nullptr);
  EXPECT_EQ(result.slam.skipped_scans, 10U);
  EXPECT_TRUE(same_bits(result.slam.occupancy, clean.slam.occupancy));
  EXPECT_EQ(result.timescale->state(), clean.timescale->state());
}

}  // namespace
}  // namespace strata::pipeline
