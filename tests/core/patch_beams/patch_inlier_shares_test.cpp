// SPDX-License-Identifier: Apache-2.0
// What beams say where a sub-map has several configurations.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include <gtest/gtest.h>

#include "core/patch_beams/patch_beam_model.hpp"

namespace strata::patch_beams {
namespace {

using localization::InlierShares;
using localization::ParticleSet;
using localization::PatchMemory;

/// Puts a wall across y = 0 to 2 m, one cell thick.
void add_wall(ReflectionGrid& grid, int x) {
  for (int y = 0; y < 40; ++y) grid.at({x, y}) = 0.9F;
}

/// A free way with a wall at x = 5 m; a sub-map holds all of it but that, with a wall in the first
/// column, in the second, or none before.
std::shared_ptr<const patch::PatchMap> two_walls_or_none(int first, int second) {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = ReflectionGrid(0.05, {{-20, 0}, {140, 40}}, 0.0F);
  add_wall(map->base, 100);
  patch::Submap submap;
  submap.rect = {{-20, 0}, {90, 40}};
  for (const int wall : {first, second, 0}) {
    patch::Configuration configuration;
    configuration.reflection = map->base.cropped(submap.rect);
    if (wall > 0) add_wall(configuration.reflection, wall);
    submap.configurations.push_back(configuration);
  }
  map->submaps.push_back(submap);
  return map;
}

class PatchInlierShares : public testing::TestWithParam<PatchMemory> {};

TEST_P(PatchInlierShares, SharesABeamAmongTheConfigurationsByTheirProbabilities) {
  PatchBeamModelConfig config;
  config.states.memory = GetParam();
  const PatchBeamModel model(two_walls_or_none(40, 60), config);
  const Pose2 robot{1.0, 1.0, 0.0};
  // 0.5, 0.3 and 0.2: of each particle, of all, or as many particles.
  ParticleSet particles;
  particles.resize(10);
  set_uniform_weights(particles);
  model.patch_states()->prepare(particles);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.set_pose(i, robot);
    particles.submap[i] = 0;
    if (GetParam() == PatchMemory::kNone) particles.configuration[i] = i < 5 ? 0 : (i < 8 ? 1 : 2);
    for (std::size_t k = 0; k < particles.belief(i).size(); ++k) {
      particles.belief(i)[k] = k == 0 ? 0.5F : (k == 1 ? 0.3F : 0.2F);
    }
  }
  if (GetParam() == PatchMemory::kShared) particles.shared_belief = {0.5F, 0.3F, 0.2F};
  const auto expect = [&](float range_m, double inlier, double at_surface, double stopped) {
    Scan scan;
    scan.range_max_m = 10.0F;
    scan.ranges_m = {range_m};
    const InlierShares said = model.inlier_shares(scan, robot, particles);
    EXPECT_NEAR(said.inlier, inlier, 1e-6) << range_m;
    EXPECT_NEAR(said.met, inlier, 1e-6) << range_m;
    EXPECT_NEAR(said.judged, 1.0, 1e-6) << range_m;
    EXPECT_NEAR(said.at_surface, at_surface, 1e-6) << range_m;
    EXPECT_NEAR(said.stopped, stopped, 1e-6) << range_m;
  };
  expect(0.5F, 0.0, 0.0, 1.0);  // before all walls
  expect(1.0F, 0.5, 1.0, 0.0);  // at the first, which is a surface whether it is there or not
  expect(1.5F, 0.0, 0.0, 0.5);  // behind it: stopped if it is not there
  expect(2.0F, 0.3, 1.0, 0.0);  // at the second
  expect(3.0F, 0.0, 0.0, 0.2);  // behind both
  expect(4.0F, 0.2, 1.0, 0.0);  // at the wall that is always there
  expect(5.0F, 0.0, 0.0, 0.0);  // behind all
}

INSTANTIATE_TEST_SUITE_P(EveryMemory, PatchInlierShares,
                         testing::Values(PatchMemory::kNone, PatchMemory::kShared,
                                         PatchMemory::kPerParticle));

TEST(PatchBelief, ManyBeamsTellTwoUnlikelyConfigurationsApartFromAfar) {
  PatchBeamModelConfig config;
  config.beam.beams.min_angle_rad = 0.0;
  const PatchBeamModel model(two_walls_or_none(40, 44), config);
  Scan scan;  // what the wall at x = 2.2 m looks like from -0.5 m
  scan.range_max_m = 10.0F;
  scan.angle_min_rad = -0.15F;
  scan.angle_increment_rad = 0.001F;
  for (int i = 0; i < 300; ++i) {
    scan.ranges_m.push_back(static_cast<float>(2.7 / std::cos(scan.bearing_rad(i))));
  }
  ParticleSet particles;
  particles.resize(1);
  model.patch_states()->prepare(particles);
  particles.set_pose(0, {-0.5, 1.0, 0.0});
  particles.submap[0] = -1;
  const float before[] = {0.001F, 0.001F, 0.998F};
  std::copy(std::begin(before), std::end(before), particles.belief(0).begin());
  double log_likelihood = 0.0;
  WorkerPool pool(1);
  // So many that each of the first two is far more than e^80 times as likely as what was believed.
  EXPECT_GT(model.log_likelihoods(scan, {1.0}, particles, std::span(&log_likelihood, 1), pool),
            100U);
  EXPECT_GT(particles.belief(0)[1], 0.99F);
  EXPECT_LT(particles.belief(0)[0], 0.01F);
}

}  // namespace
}  // namespace strata::patch_beams
