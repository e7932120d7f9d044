// SPDX-License-Identifier: Apache-2.0
// What local clouds say counts the same on whichever way a topology was found.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/topology/generation.hpp"
#include "tests/core/topology/junction_world.hpp"
#include "tests/core/topology/posterior_of.hpp"

namespace strata::topology {
namespace {

using test_world::Drive;
using test_world::posterior_of;
using test_world::total_variation;

/// Every partition by its own way, of clouds that say so little that several are left.
TopologyConfig enumeration() {
  TopologyConfig config;
  config.particles = 1000;
  config.negligible = 1e6;
  config.location.penalty_radius_m = 1.5;
  config.match.look_alike_gain = 2.0;
  config.match.failure_gain = -2.0;
  return config;
}

const Hypothesis* find(const std::vector<Hypothesis>& posterior, const Labels& labels) {
  const auto found = std::find_if(posterior.begin(), posterior.end(),
                                  [&](const Hypothesis& h) { return h.labels == labels; });
  return found == posterior.end() ? nullptr : &*found;
}

/// The drive of TopologyFilter.IsNearTheExactPosterior, with what the robot sees: four places that
/// look alike, side_m apart.
Drive seven_visits(const TopologyConfig& config, std::uint64_t seed, double side_m) {
  const std::vector<test_world::Junction> junctions{
      {0.0, 0.0, 15}, {side_m, 0.0, 15}, {side_m, side_m, 15}, {0.0, side_m, 15}};
  return test_world::drive(junctions, {0, 1, 2, 3, 0, 1, 2}, config.odometry, seed);
}

/// Means over twenty drives.
struct NearExact {
  double likeliest = 0.0;        ///< probability of the likeliest by enumeration
  double total_variation = 0.0;  ///< of the best topologies from that
};

NearExact near_exact(const TopologyConfig& config, double side_m) {
  TopologyConfig every = config;
  every.particles = 1000;
  every.negligible = 1e6;
  NearExact mean;
  constexpr std::uint64_t kRuns = 20;
  for (std::uint64_t run = 1; run <= kRuns; ++run) {
    const Drive drive = seven_visits(config, run, side_m);
    const std::vector<Hypothesis> exact = posterior_of(drive.visits, every);
    mean.likeliest += exact.front().probability / kRuns;
    mean.total_variation += total_variation(posterior_of(drive.visits, config), exact) / kRuns;
  }
  return mean;
}

TEST(ScanPosterior, IsNearTheExactOne) {
  TopologyConfig config;
  config.odometry.per_metre_m = 0.15;
  const NearExact found = near_exact(config, 12.0);
  EXPECT_LT(found.likeliest, 0.99);  // else anything would be near it
  EXPECT_LE(found.total_variation, 0.05);
}

/// Clouds say little and places lie near each other: much is left to be unsure of.
TEST(ScanPosterior, IsNearTheExactOneWhereCloudsSayLittle) {
  TopologyConfig config;
  config.odometry.per_metre_m = 0.15;
  config.match.look_alike_gain = 2.0;
  const NearExact found = near_exact(config, 4.0);
  EXPECT_LT(found.likeliest, 0.85);
  EXPECT_LE(found.total_variation, 0.05);
}

/// The particle of these labels alone, and what its revisions come to.
std::vector<Particle> revisions_of(const Hypothesis& hypothesis,
                                   const std::vector<LandmarkVisit>& visits,
                                   const TopologyConfig& config) {
  VisitLog log(config);
  for (const LandmarkVisit& visit : visits) log.add(visit);
  Generation generation;
  // As far as the odometry may be off: bounds of what landmarks are in reach.
  const std::vector<Eigen::Matrix3d> bounds(visits.size(), 100.0 * Eigen::Matrix3d::Identity());
  generation.particles.push_back({hypothesis, bounds});
  generation.log_weights.push_back(0.0);
  WorkerPool pool(1);
  add_revisions(generation, log, config, pool);
  return generation.particles;
}

/// Two visits half a metre apart that look different, and two that look the same: each topology has
/// the evidence that it has on its own way, when it is found as a revision of another one.
TEST(ScanPosterior, ARevisionPaysForTheMatchesOfItsOwnLandmarks) {
  const TopologyConfig config = enumeration();
  std::size_t compared = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const int other = seed % 2 == 0 ? 15 : 16 + 7;
    const std::vector<test_world::Junction> junctions{
        {0.0, 0.0, 15}, {5.0, 0.0, 32 + 13}, {0.4, 0.0, other}};
    const Drive drive = test_world::drive(junctions, {0, 1, 2, 1}, config.odometry, seed);
    const std::vector<Hypothesis> exact = posterior_of(drive.visits, config);
    for (const Hypothesis& from : exact) {
      if (from.probability < 1e-6) continue;  // none that would be revised
      for (const Particle& revised : revisions_of(from, drive.visits, config)) {
        const Hypothesis* own = find(exact, revised.hypothesis.labels);
        if (own == nullptr || revised.hypothesis.labels == from.labels) continue;
        if (own->probability < 1e-6) continue;
        ++compared;
        EXPECT_NEAR(revised.hypothesis.log_evidence, own->log_evidence, 0.5)
            << testing::PrintToString(from.labels) << " to " << testing::PrintToString(own->labels);
      }
    }
  }
  EXPECT_GT(compared, 6U);
}

}  // namespace
}  // namespace strata::topology
