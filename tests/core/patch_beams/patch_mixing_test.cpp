// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "core/patch_beams/event_mixture.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/random/stream.hpp"

namespace strata::patch_beams {
namespace {

using localization::ParticleSet;
using localization::PatchMemory;
using localization::PatchStates;
using localization::PatchStatesConfig;
using localization::stay_probability;

/// Sub-maps of random content on a random base; two of the rectangles may overlap. The base begins
/// at cell 0, unlike that of beam_reference.hpp: ranges in composed maps are then equal bit by bit.
std::shared_ptr<patch::PatchMap> random_map(RandomStream& random, bool overlap) {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = ReflectionGrid(0.1, {{0, 0}, {60, 20}}, 0.0F);
  for (float& m : map->base.values()) m = random.bernoulli(0.01) ? 0.9F : 0.0F;
  const int starts[] = {8, overlap ? 14 : 22, 36};
  for (int s = 0; s < 3; ++s) {
    patch::Submap submap;
    submap.id = s;
    submap.rect = {{starts[s], 2}, {starts[s] + 10, 18}};
    const int configurations = 1 + static_cast<int>(random.below(3));
    for (int k = 0; k < configurations; ++k) {
      patch::Configuration configuration;
      configuration.reflection = ReflectionGrid(0.1, submap.rect, 0.0F);
      for (float& m : configuration.reflection.values()) m = random.bernoulli(0.04) ? 0.9F : 0.0F;
      submap.configurations.push_back(configuration);
    }
    map->submaps.push_back(submap);
  }
  return map;
}

/// The composed map in which `current` wins overlaps, else the sub-map with the nearest centre.
ReflectionGrid composed(const patch::PatchMap& map, const std::vector<int>& states, int current) {
  ReflectionGrid grid = map.base;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Cell cell = grid.cell(i);
    int best = -1;
    double nearest = std::numeric_limits<double>::infinity();
    for (const patch::Submap& s : map.submaps) {
      if (!s.rect.contains(cell)) continue;
      const double d = s.id == current
                           ? -1.0
                           : std::hypot(cell.x + 0.5 - 0.5 * (s.rect.min.x + s.rect.max.x),
                                        cell.y + 0.5 - 0.5 * (s.rect.min.y + s.rect.max.y));
      if (d < nearest) {
        nearest = d;
        best = s.id;
      }
    }
    if (best >= 0) {
      const auto b = static_cast<std::size_t>(best);
      grid.values()[i] =
          map.submaps[b].configurations[static_cast<std::size_t>(states[b])].reflection.at(cell);
    }
  }
  return grid;
}

TEST(PatchMixing, EqualsEnumerationOfAllConfigurations) {
  RandomStream random(23, StreamId::kTest);
  const rays::BeamMixture mixture({}, 6.0);
  for (int round = 0; round < 40; ++round) {
    const auto map = random_map(random, round % 2 == 0);
    const PatchStates states(map, {});
    const PatchRayCaster caster(*map);
    std::vector<float> belief;
    for (std::size_t s = 0; s < 3; ++s) {
      double sum = 0.0;
      const std::size_t begin = belief.size();
      for (int k = 0; k < states.count(s); ++k) {
        belief.push_back(static_cast<float>(random.uniform(0.05, 1.0)));
        sum += static_cast<double>(belief.back());
      }
      for (std::size_t c = begin; c < belief.size(); ++c) {
        belief[c] = static_cast<float>(static_cast<double>(belief[c]) / sum);
      }
    }
    for (int ray = 0; ray < 10; ++ray) {
      const Pose2 pose{random.uniform(0.0, 6.0), random.uniform(0.0, 2.0),
                       random.uniform(-3.2, 3.2)};
      const int current = patch::submap_at(*map, pose.translation());
      const int fixed = current >= 0 && ray % 2 == 0 ? 0 : -1;
      const double z = random.uniform(0.0, 5.0);
      std::vector<RayEvent> events;
      caster.events(pose.x, pose.y, std::cos(pose.theta), std::sin(pose.theta), 6.0, current,
                    events);
      std::vector<double> values;
      for (const RayEvent& e : events) values.push_back(mixture.density(z, e.range_m));
      const double end = mixture.density(z, std::numeric_limits<double>::infinity());
      const double got =
          mix_events(events, values, end, states, belief, fixed < 0 ? -1 : current, fixed);
      double expected = 0.0;
      std::vector<int> state(3, 0);
      for (state[0] = 0; state[0] < states.count(0); ++state[0]) {
        for (state[1] = 0; state[1] < states.count(1); ++state[1]) {
          for (state[2] = 0; state[2] < states.count(2); ++state[2]) {
            double p = 1.0;
            for (std::size_t s = 0; s < 3; ++s) {
              const auto k = static_cast<std::size_t>(state[s]);
              if (fixed >= 0 && static_cast<int>(s) == current) {
                p *= state[s] == fixed ? 1.0 : 0.0;
              } else {
                p *= static_cast<double>(belief[states.offset(s) + k]);
              }
            }
            if (p == 0.0) continue;
            const rays::RayCaster one(composed(*map, state, current), 6.0);
            expected += p * mixture.density(z, one.expected_range_m(pose, 0.0));
          }
        }
      }
      EXPECT_NEAR(got, expected, 1e-6);
    }
  }
}

TEST(PatchMixing, BeamsMeetTheComposedMapWhereSubmapsOverlap) {
  RandomStream random(41, StreamId::kTest);
  int differ = 0;
  for (int round = 0; round < 60; ++round) {
    const auto map = random_map(random, true);
    for (patch::Submap& submap : map->submaps) {
      for (patch::Configuration& configuration : submap.configurations) {
        for (float& m : configuration.reflection.values()) {
          if (random.bernoulli(0.3)) m = kUnknownReflection;
        }
      }
    }
    std::vector<int> states;
    for (const patch::Submap& submap : map->submaps) {
      states.push_back(
          static_cast<int>(random.below(static_cast<std::uint32_t>(submap.configurations.size()))));
    }
    const PatchRayCaster caster(*map);
    for (const int current : {-1, 0, 1}) {
      const rays::RayCaster reference(patch::compose(*map, states, current), 6.0);
      for (int ray = 0; ray < 20; ++ray) {
        const Pose2 pose{random.uniform(0.0, 6.0), random.uniform(0.0, 2.0),
                         random.uniform(-3.2, 3.2)};
        std::vector<RayEvent> events;
        caster.events(pose.x, pose.y, std::cos(pose.theta), std::sin(pose.theta), 6.0, current,
                      events);
        double range = std::numeric_limits<double>::infinity();
        for (const RayEvent& event : events) {
          const bool ends =
              event.submap < 0 ||
              (event.mask >> states[static_cast<std::size_t>(event.submap)] & 1U) != 0;
          if (ends) range = std::min(range, event.range_m);
        }
        EXPECT_EQ(range, reference.expected_range_m(pose, 0.0));
        differ += current == 0 && range != rays::RayCaster(patch::compose(*map, states, 1), 6.0)
                                               .expected_range_m(pose, 0.0)
                      ? 1
                      : 0;
      }
    }
  }
  EXPECT_GT(differ, 20);  // the overlaps decide some of the rays
}

TEST(PatchMixing, StaysFiniteWhereWeightsOfZeroMakeBeamsImpossible) {
  RandomStream random(31, StreamId::kTest);
  WorkerPool pool(1);
  PatchBeamModelConfig config;
  config.beam.mixture.hit_weight = 1.0;
  config.beam.mixture.hit_stddev_m = 0.01;
  for (double* weight : {&config.beam.mixture.short_weight, &config.beam.mixture.max_weight,
                         &config.beam.mixture.random_weight}) {
    *weight = 0.0;
  }
  for (const PatchMemory memory :
       {PatchMemory::kNone, PatchMemory::kShared, PatchMemory::kPerParticle}) {
    config.states.memory = memory;
    for (int round = 0; round < 10; ++round) {
      const PatchBeamModel model(random_map(random, round % 2 == 0), config);
      Scan scan;
      scan.angle_increment_rad = 0.1F;
      scan.range_max_m = 6.0F;
      for (int beam = 0; beam < 63; ++beam) {
        const bool is_hit = random.bernoulli(0.7);
        scan.ranges_m.push_back(is_hit ? static_cast<float>(random.uniform(0.1, 5.0))
                                       : std::numeric_limits<float>::infinity());
      }
      ParticleSet particles;
      particles.resize(20);
      set_uniform_weights(particles);
      model.patch_states()->prepare(particles);
      for (std::size_t i = 0; i < particles.size(); ++i) {
        particles.set_pose(i, {random.uniform(0.0, 6.0), random.uniform(0.0, 2.0), 0.3});
        model.patch_states()->draw(particles, i, random);
      }
      std::vector<double> log_likelihood(particles.size());
      model.log_likelihoods(scan, {1.0}, particles, log_likelihood, pool);
      for (const double log : log_likelihood) ASSERT_TRUE(std::isfinite(log)) << log;
      for (const float p : particles.beliefs) ASSERT_TRUE(std::isfinite(p)) << p;
    }
  }
}

TEST(PatchStates, StayProbabilityIsTheRateForm) {
  EXPECT_DOUBLE_EQ(stay_probability(1, 0.1, 100.0), 1.0);
  EXPECT_DOUBLE_EQ(stay_probability(3, 0.1, 0.0), 1.0);
  EXPECT_NEAR(stay_probability(4, 0.1, 1e4), 0.25, 1e-12);
  // Two steps of dt/2 are one of dt: P(stay) + P(leave and return).
  const double half = stay_probability(3, 0.2, 1.5);
  const double whole = stay_probability(3, 0.2, 3.0);
  EXPECT_NEAR(half * half + (1.0 - half) * (1.0 - half) / 2.0, whole, 1e-12);
}

TEST(PatchStates, RedrawsAtTheRateAndUniformlyOnEntering) {
  RandomStream random(5, StreamId::kTest);
  auto map = random_map(random, false);
  map->submaps[0].configurations.resize(3, map->submaps[0].configurations[0]);
  PatchStatesConfig config;
  config.memory = PatchMemory::kNone;
  config.rates = localization::RateSource::kFixed;
  config.forgetting_rate_per_s = 0.5;
  map->entry_margin_m = 0.0;
  const PatchStates states(map, config);
  ParticleSet particles;
  particles.resize(20000);
  for (std::size_t i = 0; i < particles.size(); ++i) particles.set_pose(i, {1.2, 1.0, 0.0});
  WorkerPool pool(2);
  states.prepare(particles);
  states.predict(1.0, 9, 1, particles, pool);
  const std::vector<std::int32_t> entered = particles.configuration;
  std::vector<double> share(3, 0.0);
  for (const std::int32_t k : entered) share[static_cast<std::size_t>(k)] += 1.0 / 20000.0;
  for (const double s : share) EXPECT_NEAR(s, 1.0 / 3.0, 0.015);
  states.predict(1.0, 9, 2, particles, pool);
  double kept = 0.0;
  for (std::size_t i = 0; i < 20000; ++i) {
    kept += particles.configuration[i] == entered[i] ? 1.0 : 0.0;
  }
  EXPECT_NEAR(kept / 20000.0, stay_probability(3, 0.5, 1.0), 0.015);
  for (std::size_t i = 0; i < 20000; ++i) particles.set_pose(i, {1.95, 1.0, 0.0});
  states.predict(1.0, 9, 3, particles, pool);
  EXPECT_EQ(particles.submap[0], -1);
  EXPECT_EQ(particles.configuration[0], -1);
}

TEST(PatchStates, WithoutMemoryAParticleHoldsAConfigurationFromWithinReach) {
  RandomStream random(6, StreamId::kTest);
  const auto map = random_map(random, false);
  map->entry_margin_m = 0.5;
  const CellRect& rect = map->submaps[0].rect;
  const double edge_m = rect.min.x * map->base.resolution_m();
  const double middle_m = 0.5 * (rect.min.y + rect.max.y) * map->base.resolution_m();
  WorkerPool pool(1);
  for (const PatchMemory memory : {PatchMemory::kNone, PatchMemory::kPerParticle}) {
    PatchStatesConfig config;
    config.memory = memory;
    const PatchStates states(map, config);
    ParticleSet particles;
    particles.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
      particles.set_pose(i, {edge_m + 0.1 - 0.36 * static_cast<double>(i), middle_m, 0.0});
    }
    states.prepare(particles);
    states.predict(1.0, 9, 1, particles, pool);
    const bool is_paper = memory == PatchMemory::kNone;
    EXPECT_EQ(particles.submap[0], 0);
    EXPECT_EQ(particles.submap[1], is_paper ? 0 : -1) << "0.26 m outside";
    EXPECT_EQ(particles.configuration[1] >= 0, is_paper);
    EXPECT_EQ(particles.submap[2], -1) << "0.62 m outside";
    EXPECT_EQ(particles.configuration[2], -1);
  }
}

}  // namespace
}  // namespace strata::patch_beams
