// SPDX-License-Identifier: Apache-2.0
// What many beams at once say of a sub-map that the robot is not in.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/localization/patch_beam_model.hpp"

namespace strata::localization {
namespace {

/// A wall at x = 5 m; a sub-map before it has one at 2 m, one at 2.2 m, or none.
std::shared_ptr<const patch::PatchMap> two_walls_or_none() {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = ReflectionGrid(0.05, {{-20, 0}, {140, 40}}, 0.0F);
  const auto add_wall = [](ReflectionGrid& grid, int x) {
    for (int y = 0; y < 40; ++y) grid.at({x, y}) = 0.9F;
  };
  add_wall(map->base, 100);
  patch::Submap submap;
  submap.rect = {{20, 0}, {60, 40}};
  for (const int wall : {40, 44, 0}) {
    patch::Configuration configuration;
    configuration.reflection = map->base.cropped(submap.rect);
    if (wall > 0) add_wall(configuration.reflection, wall);
    submap.configurations.push_back(configuration);
  }
  map->submaps.push_back(submap);
  return map;
}

TEST(PatchBelief, ManyBeamsTellTwoUnlikelyConfigurationsApartFromAfar) {
  PatchBeamModelConfig config;
  config.beam.beams.least_angle_rad = 0.0;
  const PatchBeamModel model(two_walls_or_none(), config);
  Scan scan;  // what the wall at 2.2 m looks like from x = -0.5 m
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
  EXPECT_GT(model.log_likelihoods(scan, 1.0, particles, std::span(&log_likelihood, 1), pool), 100U);
  EXPECT_GT(particles.belief(0)[1], 0.99F);
  EXPECT_LT(particles.belief(0)[0], 0.01F);
}

}  // namespace
}  // namespace strata::localization
