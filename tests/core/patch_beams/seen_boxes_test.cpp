// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/seen_boxes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::patch_beams {
namespace {

using localization::LaserColumns;
using localization::ParticleSet;

/// A base map with a cell here and there that is an obstacle in one of two configurations.
patch::PatchMap dotted_map(RandomStream& random) {
  patch::PatchMap map;
  map.base = ReflectionGrid(0.1, {{0, 0}, {120, 90}}, 0.0F);
  for (int n = 0; n < 6; ++n) {
    patch::Submap submap;
    const Cell corner{static_cast<int>(random.below(100)), static_cast<int>(random.below(70))};
    submap.rect = {corner, {corner.x + 15, corner.y + 15}};
    for (int k = 0; k < 2; ++k) {
      patch::Configuration configuration;
      configuration.reflection = ReflectionGrid(0.1, submap.rect, 0.0F);
      for (float& m : configuration.reflection.values()) {
        m = k == 1 && random.bernoulli(0.02) ? 0.9F : 0.0F;
      }
      submap.configurations.push_back(configuration);
    }
    map.submaps.push_back(submap);
  }
  return map;
}

TEST(SeenBoxes, LeaveOutOnlyBoxesThatNoRayOfABeamCrosses) {
  RandomStream random(36, StreamId::kTest);
  std::size_t near = 0;
  std::size_t left_out = 0;
  for (int round = 0; round < 60; ++round) {
    const PatchRayCaster caster(dotted_map(random));
    ParticleSet particles;
    particles.resize(27);
    const Pose2 about{random.uniform(0.0, 12.0), random.uniform(0.0, 9.0),
                      random.uniform(-3.0, 3.0)};
    const double spread = round % 3 == 0 ? 3.0 : 0.2;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      particles.set_pose(i, {about.x + spread * random.uniform(-1.0, 1.0),
                             about.y + spread * random.uniform(-1.0, 1.0),
                             about.theta + spread * random.uniform(-1.0, 1.0)});
    }
    LaserColumns lasers;
    lasers.take(particles, 0, particles.size(), {});
    SeenBoxes boxes;
    boxes.take(caster, lasers, {particles.submap, {}}, 6.0);
    for (int beam = 0; beam < 36; ++beam) {
      const double c = std::cos(0.1745 * beam);
      const double s = std::sin(0.1745 * beam);
      std::vector<bool> is_near(boxes.size());
      for (const rays::BoxColumns& box : boxes.near_beam(c, s)) is_near[box.place] = true;
      for (std::size_t box = 0; box < boxes.size(); ++box) {
        (is_near[box] ? near : left_out) += 1;
        if (is_near[box]) continue;
        for (std::size_t n = 0; n < lasers.count(); ++n) {
          const double ray_c = lasers.heading_cosine()[n] * c - lasers.heading_sine()[n] * s;
          const double ray_s = lasers.heading_sine()[n] * c + lasers.heading_cosine()[n] * s;
          std::vector<RayEvent> events;
          caster.events(lasers.x_m()[n], lasers.y_m()[n], ray_c, ray_s, 6.0, -1, events);
          for (const RayEvent& event : events) {
            ASSERT_NE(event.submap, boxes.content(box, n).submap) << round << ' ' << beam;
          }
        }
      }
    }
  }
  EXPECT_GT(near, 1000U);
  EXPECT_GT(left_out, 1000U);
}

}  // namespace
}  // namespace strata::patch_beams
