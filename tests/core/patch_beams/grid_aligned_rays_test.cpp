// SPDX-License-Identifier: Apache-2.0
// Rays along the edges of cells, where roundings decide whose cells they cross.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/grid/grid.hpp"
#include "core/patch_beams/patch_beam_model.hpp"

namespace strata::patch_beams {
namespace {

using localization::ParticleSet;
using localization::PatchStates;

constexpr double kResolution_m = 0.05;

/// A wall of 4 cells by 14 that is there or not; `last` is its last row.
std::shared_ptr<patch::PatchMap> wall_or_none(int last) {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = ReflectionGrid(kResolution_m, {{0, 0}, {80, last + 40}}, 0.0F);
  patch::Submap submap;
  submap.id = 0;
  submap.rect = {{40, last - 13}, {44, last + 1}};
  for (const float fill : {0.9F, 0.0F}) {
    patch::Configuration configuration;
    configuration.reflection = ReflectionGrid(kResolution_m, submap.rect, fill);
    submap.configurations.push_back(configuration);
  }
  map->submaps.push_back(submap);
  return map;
}

/// The belief in the wall of a robot at (0.1, y) that looks along x and sees it 1.9 m away.
double belief_in_wall(const std::shared_ptr<patch::PatchMap>& map, double y_m) {
  const PatchBeamModel model(map, {});
  Scan scan;
  scan.range_max_m = 10.0F;
  scan.angle_increment_rad = 0.1F;
  scan.ranges_m = {1.9F};
  ParticleSet particles;
  particles.resize(1);
  particles.set_pose(0, {0.1, y_m, 0.0});
  const PatchStates& states = *model.patch_states();
  states.prepare(particles);
  RandomStream random(1, StreamId::kTest);
  states.draw(particles, 0, random);
  double log_likelihood = 0.0;
  WorkerPool pool(1);
  EXPECT_EQ(model.log_likelihoods(scan, {1.0}, particles, std::span(&log_likelihood, 1), pool), 1U);
  return static_cast<double>(particles.belief(0)[0]);
}

TEST(GridAlignedRays, MeetWhatIsInTheCellsTheyRunIn) {
  int near_far_edge = 0;
  for (int k = 14; k < 400; ++k) {
    const double y_m = 0.05 * k;  // on the edge of a cell
    const int row = static_cast<int>(std::floor(y_m / kResolution_m));
    near_far_edge += row == k - 1 ? 1 : 0;
    EXPECT_GT(belief_in_wall(wall_or_none(row), y_m), 0.8) << "last row, y = " << y_m;
    EXPECT_GT(belief_in_wall(wall_or_none(row + 13), y_m), 0.8) << "first row, y = " << y_m;
    EXPECT_NEAR(belief_in_wall(wall_or_none(row - 1), y_m), 0.5, 1e-6) << "beside, y = " << y_m;
  }
  EXPECT_GE(near_far_edge, 1) << "an edge that rounds into the cell before it";
}

}  // namespace
}  // namespace strata::patch_beams
