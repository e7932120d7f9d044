// SPDX-License-Identifier: Apache-2.0
#include "core/topology/generation.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/topology/evidence.hpp"

namespace strata::topology {
namespace {

/// Visits where the odometry says, to a few centimetres.
void fill(VisitLog& log, const std::vector<Pose2>& poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    LandmarkVisit visit;
    visit.stamp = {static_cast<std::int64_t>(i + 1) * 1'000'000'000};
    visit.odom_from_robot = poses[i];
    log.add(std::move(visit));
  }
}

/// Many visits lie a little too far from their landmark, and would be worse alone; the last one
/// lies two metres away.
TEST(Revisions, BeginWithTheOneThatPromisesMostHoweverManyThereAre) {
  TopologyConfig config;
  config.odometry = {.floor_m = 0.02, .per_metre_m = 0.0, .floor_rad = 0.01, .per_metre_rad = 0.0};
  config.location = {.revisit_stddev_m = 0.1, .penalty_radius_m = 1.5};
  std::vector<Pose2> poses{{0.0, 0.0, 0.0}};
  for (int i = 0; i < 20; ++i) poses.push_back({0.0, i % 2 == 0 ? 0.25 : -0.25, 0.0});
  poses.push_back({2.0, 0.0, 0.0});
  VisitLog log(config);
  fill(log, poses);
  Particle particle;
  particle.hypothesis.labels.assign(poses.size(), 0);
  const Evidence evidence = evaluate(particle.hypothesis.labels, log.measurements(poses.size()), {},
                                     poses, config.location);
  ASSERT_TRUE(evidence.converged);
  particle.hypothesis.poses = evidence.poses;
  particle.hypothesis.log_evidence = evidence.log_evidence;
  particle.hypothesis.gaussian = evidence.gaussian;
  Generation generation;
  generation.particles.push_back(particle);
  generation.log_weights.push_back(evidence.log_evidence);
  WorkerPool pool(1);
  add_revisions(generation, log, config, pool);
  const std::size_t heaviest = by_weight(generation.particles, generation.log_weights).front();
  Labels right(poses.size(), 0);
  right.back() = 1;
  EXPECT_EQ(generation.particles[heaviest].hypothesis.labels, right);
}

}  // namespace
}  // namespace strata::topology
