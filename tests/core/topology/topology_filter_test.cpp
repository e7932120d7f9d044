// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_filter.hpp"

#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/topology/proposal.hpp"
#include "tests/core/topology/junction_world.hpp"

namespace strata::topology {
namespace {

using test_world::Drive;

std::vector<Hypothesis> posterior_of(const std::vector<LandmarkVisit>& visits,
                                     const TopologyConfig& config, std::uint64_t seed = 1,
                                     int threads = 1) {
  TopologyFilter filter(config, seed, threads);
  for (const LandmarkVisit& visit : visits) EXPECT_TRUE(filter.add(visit));
  return filter.posterior();
}

double total_variation(const std::vector<Hypothesis>& a, const std::vector<Hypothesis>& b) {
  std::map<Labels, double> difference;
  for (const Hypothesis& hypothesis : a) difference[hypothesis.labels] += hypothesis.probability;
  for (const Hypothesis& hypothesis : b) difference[hypothesis.labels] -= hypothesis.probability;
  double sum = 0.0;
  for (const auto& [labels, value] : difference) sum += std::abs(value);
  return 0.5 * sum;
}

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
TopologyConfig enumeration() {
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
  for (LandmarkVisit& visit : drive.visits) visit.patch = {};
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
    const std::vector<Hypothesis> exact = posterior_of(drive.visits, enumeration());
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

struct Tally {
  int truth_first = 0;
  int above_80_percent = 0;
};

Tally tally(const std::vector<test_world::Junction>& junctions, const std::vector<int>& order,
            const OdometryNoiseConfig& noise, const TopologyConfig& config, int seeds) {
  Tally result;
  for (int i = 0; i < seeds; ++i) {
    const auto seed = static_cast<std::uint64_t>(100 + i);
    const Drive drive = test_world::drive(junctions, order, noise, seed);
    const std::vector<Hypothesis> posterior = posterior_of(drive.visits, config, seed, 2);
    const bool first = posterior.front().labels == drive.truth;
    result.truth_first += first ? 1 : 0;
    result.above_80_percent += first && posterior.front().probability > 0.8 ? 1 : 0;
  }
  return result;
}

// Twelve visits over 120 m, three looks of three junctions each.
TEST(TopologyFilter, FindsTheTruthAmongLookAlikes) {
  const Tally result = tally(test_world::nine_junctions(), test_world::twelve_visits(),
                             kLandmarkOdometryNoise, {}, 20);
  EXPECT_GE(result.above_80_percent, 19);
}

// 60 m wide, twenty visits of fourteen junctions, odometry that is 8% off.
TEST(TopologyFilter, FindsTheTruthInALargeBuildingWithFiftyBestOrDrawn) {
  TopologyConfig config;
  config.odometry.per_metre_m = 0.08;
  const std::vector<test_world::Junction> junctions = test_world::fourteen_junctions();
  const std::vector<int> order = test_world::twenty_visits();
  EXPECT_GE(tally(junctions, order, config.odometry, config, 20).truth_first, 15);
  config.expansion = Expansion::kParticles;
  EXPECT_GE(tally(junctions, order, config.odometry, config, 20).truth_first, 15);
  // A look-alike that outweighs any odometry: the truth dies out before the loop closes.
  config.match.look_alike_gain = 1000.0;
  EXPECT_EQ(tally(junctions, order, config.odometry, config, 2).truth_first, 0);
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
  broken.way_m = -1.0;
  EXPECT_FALSE(filter.add(broken));
  broken = drive.visits[2];
  broken.patch.points_m.front().x() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(filter.add(broken));
  broken.stamp.ns += 1;
  broken.patch = {};
  EXPECT_TRUE(filter.add(broken));
  EXPECT_EQ(filter.counts().late_visits, 1U);
  EXPECT_EQ(filter.counts().broken_visits, 2U);
  EXPECT_EQ(filter.counts().empty_patches, 2U);
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

/// One room of 12 m by 8 m with a pillar, seen whole from two places 3 m apart.
Drive room_with_two_places(const std::vector<int>& order) {
  Drive drive;
  drive.truth = canonical(order);
  std::vector<Eigen::Vector2d> walls;
  for (double t = 0.0; t <= 12.0; t += 0.1) {
    walls.emplace_back(t, 0.0);
    walls.emplace_back(t, 8.0);
    if (t <= 8.0) walls.emplace_back(0.0, t);
    if (t <= 8.0) walls.emplace_back(12.0, t);
    if (t <= 1.0) walls.emplace_back(3.0 + t, 6.0);
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Pose2 pose{4.5 + 3.0 * order[i], 4.0 + 0.02 * static_cast<double>(i), 0.3 * order[i]};
    LandmarkVisit visit;
    visit.stamp = {static_cast<std::int64_t>(i + 1) * 1'000'000'000};
    visit.odom_from_robot = pose;
    visit.way_m = i == 0 ? 0.0 : 3.0;
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector2d& wall : walls) seen.push_back(inverse(pose) * wall);
    visit.patch = with_normals(seen, 5);
    drive.visits.push_back(std::move(visit));
  }
  return drive;
}

TEST(TopologyFilter, DoesNotTakeTwoPlacesForOneBecauseTheySeeTheSameWalls) {
  const Drive drive = room_with_two_places({0, 1, 0, 1});
  TopologyConfig config;
  config.location.penalty_radius_m = 1.5;
  const std::vector<Hypothesis> posterior = posterior_of(drive.visits, config);
  EXPECT_EQ(posterior.front().labels, drive.truth);
  EXPECT_GT(posterior.front().probability, 0.9);
}

TEST(TopologyFilter, MakesOneLandmarkOfTwoThatALaterLoopBringsTogether) {
  Hypothesis hypothesis;
  hypothesis.labels = {0, 1, 2, 0};
  hypothesis.poses = {{0, 0, 0}, {5, 0, 1}, {5.4, 0.3, 2}, {0, 0, 0}};
  const LocationPriorConfig config;
  EXPECT_EQ(mergers(hypothesis, config), (std::vector<Labels>{{0, 1, 1, 0}}));
  hypothesis.poses[2].x = 7.0;
  EXPECT_TRUE(mergers(hypothesis, config).empty());
}

TEST(TopologyFilter, MovesAVisitToTheLandmarkThatALaterLoopPutsItAt) {
  Hypothesis hypothesis;
  hypothesis.labels = {0, 1, 1, 0};
  hypothesis.poses = {{0, 0, 0}, {5, 0, 1}, {0.3, 0, 2}, {0.2, 0, 0}};
  const LocationPriorConfig config;
  EXPECT_EQ(moved_visits(hypothesis, config), (std::vector<Labels>{{0, 1, 0, 0}, {0, 1, 2, 0}}));
  hypothesis.poses[2] = {6.2, 0, 2};  // beyond its own landmark, and far from the other
  EXPECT_EQ(moved_visits(hypothesis, config), (std::vector<Labels>{{0, 1, 2, 0}}));
  hypothesis.poses[2].x = 5.8;
  EXPECT_TRUE(moved_visits(hypothesis, config).empty());
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
      if (i == 4) visit.patch = {};
      if (i == 6) visit.stamp = drive.visits[2].stamp;
      taken += filter.add(std::move(visit)) ? 1 : 0;
      EXPECT_NEAR(sum_of(filter.posterior()), 1.0, 1e-12) << i;
    }
    EXPECT_EQ(taken, drive.visits.size() - 1);
    EXPECT_EQ(filter.counts().late_visits, 1U);
    EXPECT_EQ(filter.counts().empty_patches, 1U);
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
