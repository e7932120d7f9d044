// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/localization/roughening.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

TEST(Roughening, SpacingIsTheSideOfTheCubeOfEachPose) {
  EXPECT_NEAR(pose_spacing(10.0, 1), std::cbrt(20.0 * std::numbers::pi), 1e-12);
  EXPECT_NEAR(pose_spacing(10.0, 8000), pose_spacing(10.0, 1) / 20.0, 1e-12);
}

TEST(Roughening, MovesEachParticleByTheSpreadWhateverTheNumberOfThreads) {
  ParticleSet sets[3];
  const int threads[3] = {1, 2, 8};
  for (int n = 0; n < 3; ++n) {
    sets[n].resize(20000);
    for (std::size_t i = 0; i < sets[n].size(); ++i) sets[n].set_pose(i, {3.0, -1.0, 3.1});
    WorkerPool pool(threads[n]);
    roughen(0.2, 5, 7, sets[n], pool);
  }
  EXPECT_EQ(sets[1].x_m, sets[0].x_m);
  EXPECT_EQ(sets[2].theta_rad, sets[0].theta_rad);
  set_uniform_weights(sets[0]);
  const Pose2Gaussian pose = estimate(sets[0]);
  EXPECT_NEAR(pose.mean.x, 3.0, 0.006);
  EXPECT_NEAR(pose.mean.theta, 3.1, 0.006);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(pose.covariance(axis, axis)), 0.2, 0.004);
  }
}

/// How often, of eight starts, a robot that knows nothing loses its place in a corridor of which
/// only a pillar tells one part from the next, with a ninth of the particles that the defaults ask
/// for.
int failures(const GlobalStartConfig& start) {
  const BoxWorld world{{0.0, 0.0, 24.0, 0.4},
                       {0.0, 2.6, 24.0, 3.0},
                       {0.0, 0.0, 0.4, 3.0},
                       {23.6, 0.0, 24.0, 3.0},
                       {8.0, 0.4, 8.8, 1.1}};
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {480, 60}});
  const auto model = make_grid_beam_model(map);
  LocalizerConfig config;
  config.global_search.is_used = false;
  config.particles = 300;
  config.global_start = start;
  config.global_start.max_particles = 3000;
  int failed = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Drive drive({7.0, 1.6, 0.0}, 60 + seed);
    Localizer localizer(config, model, seed, 2);
    localizer.initialize_global(map);
    for (int n = 0; n < 24; ++n) {
      drive.step({0.12, 0.0, 0.0});
      localizer.update(drive.look(world, 4.0, 60));
    }
    failed += weighted_error(localizer.particles(), drive.truth()) > 0.5 ? 1 : 0;
  }
  return failed;
}

TEST(GlobalStart, KeepsAPlaceThatFewParticlesAreNear) {
  EXPECT_EQ(failures({}), 0);
  EXPECT_GE(failures({.roughening = 0.0}), 2);
  EXPECT_GE(failures({.annealing_factor = 1.0}), 4);
}

/// Starts anywhere, weighs every scan, and by its schedule alone would never be done here.
Localizer flat_for_long(const ReflectionGrid& map) {
  LocalizerConfig config;
  config.global_search.is_used = false;
  config.gating.every_scans = 1;
  config.global_start.annealing_updates = 1000;
  Localizer localizer(config, make_grid_beam_model(map), 4, 2);
  localizer.initialize_global(map);
  return localizer;
}

TEST(GlobalStart, IsNoLongerFlatOnceOnePlaceIsLeft) {
  const BoxWorld world{{0.0, 0.0, 6.0, 0.4}, {0.0, 3.6, 6.0, 4.0}, {0.0, 0.0, 0.4, 4.0},
                       {5.6, 0.0, 6.0, 4.0}, {2.0, 0.4, 2.6, 1.3}, {4.0, 2.9, 5.2, 3.6}};
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {120, 80}});
  Localizer localizer = flat_for_long(map);
  Drive drive({1.2, 2.0, 0.0}, 64);
  const std::size_t particles = localizer.particles().size();
  bool converged = false;
  for (int n = 0; n < 20 && !converged; ++n) {
    drive.step({0.02, 0.0, 0.0});
    converged = localizer.update(drive.look(world, 8.0, 60)).converged;
  }
  ASSERT_TRUE(converged);
  drive.step({0.02, 0.0, 0.0});
  localizer.update(drive.look(world, 8.0, 60));
  drive.step({0.02, 0.0, 0.0});
  localizer.update(drive.look(world, 8.0, 60));
  EXPECT_LT(weighted_error(localizer.particles(), drive.truth()), 0.3);
  // Held by the schedule, they would still be nearly all there.
  EXPECT_LT(localizer.particles().size(), particles / 2);
}

TEST(GlobalStart, StaysFlatWhileTwoHeadingsAreLeft) {
  // The same when turned round, with the robot beside its middle.
  const BoxWorld world{{0.0, 0.0, 6.0, 0.4}, {0.0, 3.6, 6.0, 4.0}, {0.0, 0.0, 0.4, 4.0},
                       {5.6, 0.0, 6.0, 4.0}, {1.0, 0.4, 1.6, 1.3}, {4.4, 2.7, 5.0, 3.6}};
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {120, 80}});
  Localizer localizer = flat_for_long(map);
  const std::size_t all = localizer.particles().size();
  Drive drive({3.1, 2.0, 0.0}, 64);
  LocalizationResult result;
  for (int n = 0; n < 12; ++n) {
    drive.step({0.01, 0.0, 0.0});
    result = localizer.update(drive.look(world, 8.0, 60));
  }
  ASSERT_TRUE(result.converged) << "both places lie within half a metre";
  ASSERT_GT(result.pose.covariance(2, 2), 1.0) << "and are both left";
  EXPECT_GT(localizer.particles().size(), all * 9 / 10);
}

}  // namespace
}  // namespace strata::localization
