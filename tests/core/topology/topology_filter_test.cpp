// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_filter.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/topology/proposal.hpp"
#include "tests/core/topology/junction_world.hpp"
#include "tests/core/topology/posterior_of.hpp"

namespace strata::topology {
namespace {

using test_world::Drive;
using test_world::posterior_of;
using test_world::total_variation;

double sum_of(const std::vector<Hypothesis>& posterior) {
  double sum = 0.0;
  for (const Hypothesis& hypothesis : posterior) sum += hypothesis.probability;
  return sum;
}

/// Odometry so bad that several topologies of `ambiguous_drive` are left.
TopologyConfig with_bad_odometry() {
  TopologyConfig config;
  config.odometry.per_metre_m = 0.15;
  return config;
}

/// Every partition, none left out.
TopologyConfig enumerated() {
  TopologyConfig config = with_bad_odometry();
  config.particles = 1000;
  config.negligible = 1e6;
  return config;
}

/// Seven visits known by odometry alone.
Drive ambiguous_drive(std::uint64_t seed) {
  const std::vector<test_world::Junction> junctions{
      {0.0, 0.0, 15}, {12.0, 0.0, 15}, {12.0, 12.0, 15}, {0.0, 12.0, 15}};
  Drive drive =
      test_world::drive(junctions, {0, 1, 2, 3, 0, 1, 2}, with_bad_odometry().odometry, seed);
  for (LandmarkVisit& visit : drive.visits) visit.cloud = {};
  return drive;
}

TEST(TopologyFilter, KeepsTheMostProbableFirstAndSumsToOne) {
  const Drive drive = test_world::drive(test_world::nine_junctions(), test_world::twelve_visits(),
                                        kLandmarkOdometryNoise, 3);
  TopologyFilter filter({}, 1);
  EXPECT_TRUE(filter.posterior().empty());
  for (const LandmarkVisit& visit : drive.visits) {
    ASSERT_TRUE(filter.add(visit));
    const std::vector<Hypothesis>& posterior = filter.posterior();
    EXPECT_NEAR(sum_of(posterior), 1.0, 1e-12);
    for (std::size_t i = 1; i < posterior.size(); ++i) {
      EXPECT_GE(posterior[i - 1].probability, posterior[i].probability);
      EXPECT_TRUE(is_canonical(posterior[i].labels));
    }
  }
}

// docs/theory/topological_mapping.md, "Test worlds": mean over runs of 50 particles, up to 7
// visits, that leave something to be unsure of.
TEST(TopologyFilter, IsNearTheExactPosterior) {
  double best = 0.0;
  double corrected = 0.0;
  double as_printed = 0.0;
  double plain = 0.0;
  double likeliest = 0.0;
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    const auto seed = static_cast<std::uint64_t>(run + 1);
    const Drive drive = ambiguous_drive(seed);
    const std::vector<Hypothesis> exact = posterior_of(drive.visits, enumerated());
    likeliest += exact.front().probability / kRuns;
    TopologyConfig config = with_bad_odometry();
    best += total_variation(posterior_of(drive.visits, config), exact) / kRuns;
    config.expansion = Expansion::kParticles;
    corrected += total_variation(posterior_of(drive.visits, config, seed), exact) / kRuns;
    config.weighting = Weighting::kPaper;
    as_printed += total_variation(posterior_of(drive.visits, config, seed), exact) / kRuns;
    config.proposal = Proposal::kPrior;
    plain += total_variation(posterior_of(drive.visits, config, seed), exact) / kRuns;
  }
  RecordProperty("best", std::to_string(best));
  RecordProperty("corrected", std::to_string(corrected));
  RecordProperty("as_printed", std::to_string(as_printed));
  RecordProperty("plain", std::to_string(plain));
  RecordProperty("likeliest", std::to_string(likeliest));
  EXPECT_LT(likeliest, 0.9);  // else anything would be near it
  EXPECT_LE(best, 0.05);
  EXPECT_LE(corrected, 0.05);
  EXPECT_LT(corrected, as_printed);
  EXPECT_LT(corrected, plain);
}

TEST(TopologyFilter, GivesTheSameBitsForAnyNumberOfThreads) {
  const Drive drive = test_world::drive(test_world::nine_junctions(), test_world::twelve_visits(),
                                        kLandmarkOdometryNoise, 5);
  TopologyConfig config;
  config.expansion = Expansion::kParticles;
  const std::vector<Hypothesis> one = posterior_of(drive.visits, config, 7, 1);
  for (const int threads : {2, 8}) {
    const std::vector<Hypothesis> other = posterior_of(drive.visits, config, 7, threads);
    ASSERT_EQ(other.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(other[i].labels, one[i].labels);
      EXPECT_EQ(other[i].probability, one[i].probability);
      EXPECT_EQ(other[i].poses, one[i].poses);
    }
  }
}

TEST(TopologyFilter, PutsTheLandmarksWhereTheyAre) {
  const Drive drive = test_world::drive(test_world::nine_junctions(), test_world::twelve_visits(),
                                        kLandmarkOdometryNoise, 11);
  TopologyFilter filter({}, 1);
  for (const LandmarkVisit& visit : drive.visits) filter.add(visit);
  const std::vector<Pose2Gaussian> locations = filter.locations(filter.posterior().front());
  ASSERT_EQ(locations.size(), drive.poses.size());
  for (std::size_t i = 1; i < locations.size(); ++i) {
    // Four standard deviations and a little: 36 numbers, one seed.
    EXPECT_LT(mahalanobis_squared(locations[i], drive.poses[i]), 30.0) << "visit " << i;
  }
}

TEST(TopologyFilter, SkipsAndCountsVisitsThatCannotBe) {
  Drive drive =
      test_world::drive(test_world::nine_junctions(), {0, 1, 2}, kLandmarkOdometryNoise, 2);
  TopologyFilter filter({}, 1);
  EXPECT_TRUE(filter.add(drive.visits[0]));
  EXPECT_TRUE(filter.add(drive.visits[1]));
  EXPECT_FALSE(filter.add(drive.visits[0]));  // older than the last
  LandmarkVisit broken = drive.visits[2];
  broken.odom_from_robot.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(filter.add(broken));
  broken = drive.visits[2];
  broken.path_length_m = -1.0;
  EXPECT_FALSE(filter.add(broken));
  broken = drive.visits[2];
  broken.cloud.points_m.front().x() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(filter.add(broken));
  broken.stamp.ns += 1;
  broken.cloud = {};
  EXPECT_TRUE(filter.add(broken));
  EXPECT_EQ(filter.counts().late_visits, 1U);
  EXPECT_EQ(filter.counts().broken_visits, 2U);
  EXPECT_EQ(filter.counts().empty_clouds, 2U);
  EXPECT_EQ(filter.visits(), 4U);
  EXPECT_NEAR(sum_of(filter.posterior()), 1.0, 1e-12);
}

TEST(TopologyFilter, StaysNormalizedAndSaysThatTwoLandmarksLieWithinAMetre) {
  const std::vector<test_world::Junction> junctions{{0.0, 0.0, 15}, {0.6, 0.0, 7}, {9.0, 0.0, 13}};
  const Drive drive = test_world::drive(junctions, {0, 1, 2, 1, 0}, kLandmarkOdometryNoise, 8);
  TopologyConfig config;
  config.location.revisit_stddev_m = 0.25;  // twice that is less than their distance
  TopologyFilter filter(config, 1);
  std::size_t most_near = 0;
  for (const LandmarkVisit& visit : drive.visits) {
    EXPECT_TRUE(filter.add(visit));
    EXPECT_NEAR(sum_of(filter.posterior()), 1.0, 1e-12);
    most_near = std::max(most_near, filter.counts().near_landmarks);
  }
  const std::vector<Hypothesis>& posterior = filter.posterior();
  EXPECT_EQ(posterior.front().labels, drive.truth);
  EXPECT_EQ(most_near, 1U);
  for (const Hypothesis& hypothesis : posterior) {
    EXPECT_TRUE(std::isfinite(hypothesis.log_evidence));
    EXPECT_EQ(hypothesis.poses.size(), drive.visits.size());
  }
}

/// However long the drive: as many topologies as are kept, twice, and the revisions.
TEST(TopologyFilter, TriesNoMoreTopologiesAVisitAfterAHundredThanAfterTen) {
  std::vector<int> order;
  for (int round = 0; round < 9; ++round) {
    for (const int place : test_world::twelve_visits()) order.push_back(place);
  }
  const Drive drive =
      test_world::drive(test_world::nine_junctions(), order, kLandmarkOdometryNoise, 4);
  TopologyConfig config;
  config.particles = 10;
  for (const Expansion expansion : {Expansion::kBest, Expansion::kParticles}) {
    config.expansion = expansion;
    TopologyFilter filter(config, 1);
    std::size_t before = 0;
    std::size_t most = 0;
    for (const LandmarkVisit& visit : drive.visits) {
      ASSERT_TRUE(filter.add(visit));
      most = std::max(most, filter.counts().optimized - before);
      before = filter.counts().optimized;
      EXPECT_LE(filter.posterior().size(), 10U);
    }
    EXPECT_GT(most, 0U);
    EXPECT_LE(most, 2U * 10U + 12U);
  }
}

/// Whatever is wrong with a visit, the posterior stays one, and the counts say what it was.
TEST(TopologyFilter, StaysNormalizedAndSaysWhyWhateverComes) {
  Drive drive = test_world::drive(test_world::nine_junctions(), test_world::twelve_visits(),
                                  kLandmarkOdometryNoise, 3);
  TopologyConfig config;
  config.match.min_overlap = 1.0;  // every match fails
  for (const Expansion expansion : {Expansion::kBest, Expansion::kParticles}) {
    config.expansion = expansion;
    TopologyFilter filter(config, 1);
    std::size_t taken = 0;
    for (std::size_t i = 0; i < drive.visits.size(); ++i) {
      LandmarkVisit visit = drive.visits[i];
      if (i == 4) visit.cloud = {};
      if (i == 6) visit.stamp = drive.visits[2].stamp;
      taken += filter.add(std::move(visit)) ? 1 : 0;
      EXPECT_NEAR(sum_of(filter.posterior()), 1.0, 1e-12) << i;
    }
    EXPECT_EQ(taken, drive.visits.size() - 1);
    EXPECT_EQ(filter.counts().late_visits, 1U);
    EXPECT_EQ(filter.counts().empty_clouds, 1U);
    EXPECT_GT(filter.counts().failed_matches, 0U);
    EXPECT_EQ(filter.posterior().front().labels.size(), taken);
  }
}

TEST(TopologyFilter, RefusesASettingThatCannotWork) {
  TopologyConfig config;
  config.concentration = 0.0;
  EXPECT_THROW(TopologyFilter(config, 1), ConfigError);
}

}  // namespace
}  // namespace strata::topology
