// SPDX-License-Identifier: Apache-2.0
// The patch beam model, which follows beams of many particles at once, against a reference that
// follows one beam after the other with PatchRayCaster::events and mix_events.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch_beams/event_mixture.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch_beams/beam_reference.hpp"
#include "tests/support/every_target.hpp"

namespace strata::patch_beams {
namespace {

using localization::InlierShares;
using localization::ParticleSet;
using localization::PatchMemory;
using localization::PatchStates;

using namespace test_reference;

class PatchBeams : public ::testing::TestWithParam<PatchMemory> {};

TEST_P(PatchBeams, WeighAsTheReferenceDoesBeamByBeam) {
  RandomStream random(31, StreamId::kTest);
  int changed = 0;
  for (int round = 0; round < 40; ++round) {
    const auto map =
        random_map(random, round % 2 == 0, round % 3 == 0 ? 4 : 2, round % 4 == 1 || round > 15);
    PatchBeamModelConfig config;
    config.states.memory = GetParam();
    config.states.min_belief = 0.0;
    const PatchBeamModel model(map, config);
    const PatchStates& states = *model.patch_states();
    const Scan scan = random_scan(random);
    ParticleSet particles = random_particles(states, random, 90);
    const ParticleSet before = particles;
    std::vector<double> got(particles.size());
    WorkerPool pool(1);
    model.log_likelihoods(scan, {kTempering}, particles, got, pool);
    const Reference reference(*map, states, scan);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Slow expected = reference.weigh(before, i);
      ASSERT_NEAR(got[i], expected.log_likelihood, 1e-5) << round << " " << i;
      for (std::size_t c = 0; c < expected.row.size(); ++c) {
        const auto belief = static_cast<double>(particles.belief(i)[c]);
        ASSERT_NEAR(belief, expected.row[c], 2e-6 + 1e-5 * expected.row[c]) << round << " " << i;
        changed += particles.belief(i)[c] != before.belief(i)[c] ? 1 : 0;
      }
    }
  }
  if (GetParam() != PatchMemory::kNone) {
    EXPECT_GT(changed, 1000);
  }
}

TEST_P(PatchBeams, GiveTheSameBitsOnEveryTargetAndAnyNumberOfThreads) {
  RandomStream random(32, StreamId::kTest);
  for (int round = 0; round < 4; ++round) {
    const auto map = random_map(random, round % 2 == 0, 3, round > 1);
    PatchBeamModelConfig config;
    config.states.memory = GetParam();
    const PatchBeamModel model(map, config);
    const Scan scan = random_scan(random);
    const ParticleSet before = random_particles(*model.patch_states(), random, 333);
    std::vector<double> first;
    std::vector<float> first_beliefs;
    const auto weigh = [&](int threads) {
      ParticleSet particles = before;
      std::vector<double> got(particles.size());
      WorkerPool pool(threads);
      model.log_likelihoods(scan, {kTempering}, particles, got, pool);
      if (first.empty()) {
        first = got;
        first_beliefs = particles.beliefs;
      }
      ASSERT_EQ(got, first);
      ASSERT_EQ(particles.beliefs, first_beliefs);
    };
    for (const int threads : {1, 2, 8}) weigh(threads);
    test::for_every_target([&] { weigh(1); });
  }
}

TEST_P(PatchBeams, ExplainAsTheReferenceDoesBeamByBeam) {
  RandomStream random(35, StreamId::kTest);
  double inlier = 0.0;
  for (int round = 0; round < 60; ++round) {
    const auto map = random_map(random, round % 2 == 0, 3, round % 3 > 0);
    PatchBeamModelConfig config;
    config.states.memory = GetParam();
    const PatchBeamModel model(map, config);
    const Scan scan = random_scan(random);
    const ParticleSet particles = random_particles(*model.patch_states(), random, 40);
    const Reference reference(*map, *model.patch_states(), scan);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const InlierShares got = model.inlier_shares(scan, particles.pose(i), particles);
      const InlierShares expected = reference.inlier_shares(particles, i);
      ASSERT_NEAR(got.inlier, expected.inlier, 1e-9) << round << " " << i;
      ASSERT_NEAR(got.judged, expected.judged, 1e-9) << round << " " << i;
      inlier += got.inlier;
    }
  }
  EXPECT_GT(inlier, 10.0);
}

/// 64 sub-maps of one column each along x; every second one has obstacles in both of its
/// configurations, the others are uniform.
std::shared_ptr<const patch::PatchMap> striped_map(RandomStream& random) {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = ReflectionGrid(0.1, {{-10, -5}, {75, 28}}, 0.0F);
  for (int s = 0; s < 64; ++s) {
    patch::Submap submap;
    submap.id = s;
    submap.rect = {{s, 0}, {s + 1, 20}};
    for (int k = 0; k < 2; ++k) {
      patch::Configuration configuration;
      configuration.reflection = ReflectionGrid(0.1, submap.rect, 0.0F);
      for (float& m : configuration.reflection.values()) {
        m = (k == 1 || s % 2 == 0) && random.bernoulli(0.12) ? 0.9F : 0.0F;
      }
      submap.configurations.push_back(configuration);
    }
    map->submaps.push_back(submap);
  }
  return map;
}

/// How many events of the beams of a scan lie in boxes that BoxCrossings cannot name, and how many
/// beams met more than eight sub-maps.
struct Crowd {
  int unnamed = 0;
  int in_many = 0;
  Crowd(const patch::PatchMap& map, const ParticleSet& particles, const rays::ScanBeams& beams) {
    const PatchRayCaster caster(map);
    std::vector<RayEvent> events;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
      for (const double bearing : beams.bearing_rad) {
        caster.events(laser.x, laser.y, std::cos(laser.theta + bearing),
                      std::sin(laser.theta + bearing), beams.r_max_m, particles.submap[i], events);
        in_many += events.size() > 8 ? 1 : 0;
        for (const RayEvent& event : events) {
          const auto place = static_cast<std::size_t>(std::max(0, event.submap));
          unnamed += place >= rays::BoxCrossings::kNamed + 4 ? 1 : 0;
        }
      }
    }
  }
};

TEST_P(PatchBeams, WeighAsTheReferenceDoesWhereABeamCrossesMoreBoxesThanCanBeNamed) {
  RandomStream random(37, StreamId::kTest);
  const auto map = striped_map(random);
  PatchBeamModelConfig config;
  config.states.memory = GetParam();
  config.states.min_belief = 0.0;
  const PatchBeamModel model(map, config);
  Scan scan = random_scan(random);
  scan.range_max_m = 9.0F;
  ParticleSet particles = random_particles(*model.patch_states(), random, 90);
  // Along the stripes as well.
  for (std::size_t i = 0; i < particles.size(); i += 2) {
    particles.set_pose(i, {random.uniform(-0.5, 0.0), random.uniform(0.5, 1.5), 0.0});
    model.patch_states()->draw(particles, i, random);
  }
  const ParticleSet before = particles;
  const Crowd crowd(*map, before, rays::select_beams(scan, {}));
  EXPECT_GT(crowd.unnamed, 100);
  EXPECT_GT(crowd.in_many, 20);
  std::vector<double> got(particles.size());
  WorkerPool pool(1);
  model.log_likelihoods(scan, {kTempering}, particles, got, pool);
  const Reference reference(*map, *model.patch_states(), scan);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Slow expected = reference.weigh(before, i);
    ASSERT_NEAR(got[i], expected.log_likelihood, 1e-5) << i;
    for (std::size_t c = 0; c < expected.row.size(); ++c) {
      ASSERT_NEAR(static_cast<double>(particles.belief(i)[c]), expected.row[c],
                  2e-6 + 1e-5 * expected.row[c])
          << i << " " << c;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryMemory, PatchBeams,
                         ::testing::Values(PatchMemory::kNone, PatchMemory::kShared,
                                           PatchMemory::kPerParticle));

TEST(RayBoxes, HoldTheOwnersOfAllThatRaysMeetInThem) {
  RandomStream random(34, StreamId::kTest);
  int met = 0;
  int without = 0;
  for (int round = 0; round < 40; ++round) {
    const auto map = random_map(random, round % 2 == 0, round % 3 == 0 ? 4 : 2);
    const PatchRayCaster caster(*map);
    std::vector<RayEvent> events;
    for (int n = 0; n < 200; ++n) {
      const int current = static_cast<int>(random.below(4)) - 1;
      const double x = random.uniform(-0.5, 6.0);
      const double y = random.uniform(-0.3, 2.4);
      const double angle = random.uniform(-3.1, 3.1);
      caster.events(x, y, std::cos(angle), std::sin(angle), 5.0, current, events);
      for (const RayEvent& event : events) {
        if (event.submap < 0) continue;
        const double at_x = x + event.range_m * std::cos(angle);
        const double at_y = y + event.range_m * std::sin(angle);
        std::uint64_t held = 0;
        for (const rays::RayBox& whole : caster.boxes()) {
          const rays::RayBox& box = caster.seen(whole, current);
          if (at_x < box.min_x_m || at_x > box.max_x_m || at_y < box.min_y_m || at_y > box.max_y_m)
            continue;
          for (const CellOwner& owner : caster.owners_in(box, current)) {
            if (owner.submap == event.submap) held |= owner.mask;
          }
        }
        ASSERT_EQ(held & event.mask, event.mask) << round << ' ' << n;
        ++met;
      }
    }
    for (const rays::RayBox& box : caster.boxes()) {
      for (int s = 0; s < 3; ++s) without += caster.may_end_beams(box, s, 0) ? 0 : 1;
    }
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(without, 10);  // there are boxes in which the known configuration has nothing
}

}  // namespace
}  // namespace strata::patch_beams
