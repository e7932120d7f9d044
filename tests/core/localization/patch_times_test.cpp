// SPDX-License-Identifier: Apache-2.0
/// What a filter believes of sub-maps that it does not see, by the time of day.
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/random/stream.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

constexpr double kHour_s = 3600.0;

Stamp at_hour(double hour) { return Stamp::from_seconds(kHour_s * hour); }

/// The box stands there by day, 88% at noon, and is away by night.
std::shared_ptr<patch::PatchMap> map_by_day() {
  auto map = test::box_map();
  patch::Submap& submap = map->submaps[0];
  submap.configurations[0].prior = 0.5;
  submap.configurations[1].prior = 0.5;
  submap.change_rate_per_s = 1.0 / 600.0;
  submap.usual = {{0.0, 0.0}, {{7, {0.0, -2.0}, {0.0, 0.0}}}};
  return map;
}

double share_at_noon() { return 1.0 / (1.0 + std::exp(-2.0)); }

ParticleSet particles_in(const PatchStates& states, std::size_t count) {
  ParticleSet particles;
  particles.resize(count);
  for (std::size_t i = 0; i < count; ++i) particles.set_pose(i, {5.0, 1.5, 0.0});
  set_uniform_weights(particles);
  states.prepare(particles);
  RandomStream random(1, StreamId::kTest);
  for (std::size_t i = 0; i < count; ++i) states.draw(particles, i, random);
  return particles;
}

TEST(PatchTimes, WhoSawNothingExpectsWhatIsUsualThen) {
  const auto map = map_by_day();
  for (const PatchMemory memory : {PatchMemory::kShared, PatchMemory::kPerParticle}) {
    const PatchStates states(map, {.memory = memory});
    EXPECT_TRUE(states.follows_time());
    ParticleSet particles = particles_in(states, 1);
    EXPECT_NEAR(states.posterior(particles)[0].probability[1], 0.5, 1e-6) << "at no known time";
    states.tell_time(at_hour(12.0), particles);
    states.prepare(particles);
    RandomStream random(1, StreamId::kTest);
    states.draw(particles, 0, random);
    EXPECT_NEAR(states.posterior(particles)[0].probability[1], share_at_noon(), 1e-6);
    EXPECT_NEAR(states.usual(particles)[0] + states.usual(particles)[1], 1.0, 1e-6);
  }
}

TEST(PatchTimes, WhatWasSeenFadesToWhatIsUsualThen) {
  const auto map = map_by_day();
  WorkerPool pool(1);
  for (const PatchMemory memory : {PatchMemory::kShared, PatchMemory::kPerParticle}) {
    const PatchStates states(map, {.memory = memory});
    ParticleSet particles = particles_in(states, 1);
    states.tell_time(at_hour(0.0), particles);
    states.predict(36000.0, 1, 1, particles, pool);
    EXPECT_NEAR(states.posterior(particles)[0].probability[1], 1.0 - share_at_noon(), 1e-5);
    states.tell_time(at_hour(12.0), particles);
    states.predict(600.0, 1, 2, particles, pool);
    const double kept = std::exp(-1.0);
    EXPECT_NEAR(states.posterior(particles)[0].probability[1],
                kept * (1.0 - share_at_noon()) + (1.0 - kept) * share_at_noon(), 1e-5);
  }
}

TEST(PatchTimes, WithoutMemoryConfigurationsAreDrawnAsIsUsualThen) {
  constexpr std::size_t kParticles = 20000;
  const PatchStates states(map_by_day(), {.memory = PatchMemory::kNone});
  ParticleSet particles = particles_in(states, kParticles);
  WorkerPool pool(2);
  states.tell_time(at_hour(12.0), particles);
  states.predict(36000.0, 1, 1, particles, pool);
  EXPECT_NEAR(states.posterior(particles)[0].probability[1], share_at_noon(), 0.01);
}

TEST(PatchTimes, ANewMapKnowsWhatTimeItIs) {
  const PatchStates before(map_by_day(), {});
  ParticleSet particles = particles_in(before, 1);
  before.tell_time(at_hour(12.0), particles);
  auto other = map_by_day();
  other->submaps[0].usual.harmonics[0].cosine[1] = 2.0;  // there by night
  const PatchStates after(other, {});
  after.adopt(nullptr, 1, 1, particles);
  EXPECT_NEAR(after.posterior(particles)[0].probability[1], 1.0 - share_at_noon(), 1e-6);
}

TEST(PatchTimes, OfMapsThatCameWithoutThemAreThoseOfTheirSequences) {
  auto map = map_by_day();
  patch::Submap& submap = map->submaps[0];
  submap.usual = {};
  submap.change_rate_per_s = 0.0;
  RandomStream random(3, StreamId::kTest);
  for (int day = 0; day < 20; ++day) {
    for (double hour = 1.0; hour < 24.0; hour += 2.0) {
      const bool is_there = random.bernoulli(hour > 6.0 && hour < 18.0 ? 0.9 : 0.1);
      patch::SequenceInfo sequence;
      sequence.begin = at_hour(24.0 * day + hour);
      sequence.end = at_hour(24.0 * day + hour + 0.01);
      sequence.membership = {is_there ? 0.0 : 1.0, is_there ? 1.0 : 0.0};
      submap.sequences.push_back(sequence);
    }
  }
  const PatchStates states(map, {});
  ASSERT_TRUE(states.follows_time());
  ParticleSet particles = particles_in(states, 1);
  states.tell_time(at_hour(24.0 * 500.0 + 12.0), particles);
  EXPECT_GT(states.usual(particles)[1], 0.75F);
  states.tell_time(at_hour(24.0 * 500.0), particles);
  EXPECT_LT(states.usual(particles)[1], 0.25F);
}

/// One beam against the wall behind the robot, which sees nothing of the box.
Observation look_away(double hour) {
  Observation observation;
  observation.scan.stamp = at_hour(hour);
  observation.scan.angle_min_rad = static_cast<float>(std::numbers::pi);
  observation.scan.range_max_m = 10.0F;
  observation.scan.ranges_m = {1.2F};
  return observation;
}

TEST(PatchTimes, TheFirstScanOfTheDayExpectsTheBoxAsItIsThen) {
  LocalizerConfig config;
  config.particles = 100;
  config.adaptive = false;
  config.gating.every_scans = 1;
  for (const PatchMemory memory : {PatchMemory::kShared, PatchMemory::kPerParticle}) {
    patch_beams::PatchBeamModelConfig sensor;
    sensor.states.memory = memory;
    Localizer localizer(config, std::make_shared<patch_beams::PatchBeamModel>(map_by_day(), sensor),
                        1, 1);
    const auto start = [&] {
      localizer.initialize({{1.5, 2.2, 0.0}, Eigen::Vector3d(1e-6, 1e-6, 1e-8).asDiagonal()});
    };
    const auto there_after = [&](double hour) {
      return localizer.update(look_away(hour)).submaps.at(0).probability.at(1);
    };
    start();
    EXPECT_NEAR(there_after(12.0), share_at_noon(), 1e-3);
    EXPECT_NEAR(there_after(24.0), 1.0 - share_at_noon(), 1e-3) << "twelve hours later";
    start();
    EXPECT_NEAR(there_after(24.0), 1.0 - share_at_noon(), 1e-3) << "begun at midnight";
    localizer.set_model(std::make_shared<patch_beams::PatchBeamModel>(map_by_day(), sensor));
    EXPECT_NEAR(there_after(36.0), share_at_noon(), 1e-3) << "with a map that came meanwhile";
  }
}

TEST(PatchTimes, ParticlesThatAreDrawnAnewKnowWhatTimeItIs) {
  const PatchStates states(map_by_day(), {});
  ParticleSet particles = particles_in(states, 1);
  states.tell_time(at_hour(12.0), particles);
  ParticleSet drawn;
  drawn.share(particles);
  EXPECT_EQ(drawn.time, at_hour(12.0));
  EXPECT_NEAR(states.usual(drawn)[1], share_at_noon(), 1e-6);
}

TEST(PatchTimes, AFilterThatIsRestoredKnowsWhatTimeItWas) {
  LocalizerConfig config;
  config.particles = 10;
  config.adaptive = false;
  config.gating.every_scans = 1;
  const auto model = std::make_shared<patch_beams::PatchBeamModel>(
      map_by_day(), patch_beams::PatchBeamModelConfig{});
  Localizer localizer(config, model, 1, 1);
  localizer.initialize({{1.5, 2.2, 0.0}, Eigen::Vector3d(1e-6, 1e-6, 1e-8).asDiagonal()});
  (void)localizer.update(look_away(12.0));
  Localizer restored(config, model, 1, 1);
  const auto state = localizer.saved_state();
  ASSERT_TRUE(state);
  restored.restore(*state, "the state");
  EXPECT_EQ(restored.particles().time, at_hour(12.0));
  EXPECT_EQ(restored.particles().usual, localizer.particles().usual);
}

TEST(PatchTimes, FixedRatesAndDamagedWavesKnowNoTime) {
  EXPECT_FALSE(PatchStates(map_by_day(), {.rates = RateSource::kFixed}).follows_time());
  auto map = map_by_day();
  map->submaps[0].usual.logit.push_back(0.0);
  EXPECT_FALSE(PatchStates(map, {}).follows_time());
}

}  // namespace
}  // namespace strata::localization
