// SPDX-License-Identifier: Apache-2.0
// Places that look alike, which odometry and neighbours must tell apart.
#include <vector>

#include <gtest/gtest.h>

#include "core/topology/topology_filter.hpp"
#include "tests/core/topology/junction_world.hpp"
#include "tests/core/topology/posterior_of.hpp"

namespace strata::topology {
namespace {

using test_world::Drive;
using test_world::posterior_of;

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
    visit.path_length_m = i == 0 ? 0.0 : 3.0;
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector2d& wall : walls) seen.push_back(inverse(pose) * wall);
    visit.cloud = with_normals(seen, 5);
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

}  // namespace
}  // namespace strata::topology
