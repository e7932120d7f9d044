// SPDX-License-Identifier: Apache-2.0
// How what is known of a sub-map fades, and to what.
#include <cmath>
#include <limits>
#include <span>

#include <gtest/gtest.h>

#include "core/localization/patch_states.hpp"
#include "core/random/stream.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

using test::box_map;
using test::empty_map;
using test::room;
using test::room_with_box;
using test::submap_of;

/// Sequences of a door that is open `open` of the time and drawn anew at the rate; dt apart.
std::vector<patch::SequenceInfo> door(double open, double rate_per_s, double dt_s, int count,
                                      std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  std::vector<patch::SequenceInfo> sequences;
  bool is_open = random.bernoulli(open);
  for (int i = 0; i < count; ++i) {
    if (!random.bernoulli(std::exp(-rate_per_s * dt_s))) is_open = random.bernoulli(open);
    patch::SequenceInfo sequence;
    sequence.begin = Stamp::from_seconds(i * (dt_s + 10.0));
    sequence.end = Stamp::from_seconds(i * (dt_s + 10.0) + 10.0);
    sequence.membership = {is_open ? 0.0 : 1.0, is_open ? 1.0 : 0.0};
    sequences.push_back(sequence);
  }
  return sequences;
}

std::shared_ptr<patch::PatchMap> door_map(double open, double rate_per_s) {
  auto map = box_map();
  map->submaps[0].configurations[0].prior = 1.0 - open;
  map->submaps[0].configurations[1].prior = open;
  map->submaps[0].change_rate_per_s = rate_per_s;
  return map;
}

/// What is believed of the first sub-map: of one particle, or of all.
std::span<float> row_of(const PatchStates& states, ParticleSet& particles) {
  return states.memory() == PatchMemory::kShared ? std::span<float>(particles.shared_belief)
                                                 : particles.belief(0);
}

ParticleSet one_particle(const PatchStates& states) {
  ParticleSet particles;
  particles.resize(1);
  particles.set_pose(0, {5.0, 2.0, 0.0});
  set_uniform_weights(particles);
  states.prepare(particles);
  RandomStream random(1, StreamId::kTest);
  states.draw(particles, 0, random);
  return particles;
}

TEST(PatchRates, AtFirstSightADoorIsExpectedAsItUsuallyIs) {
  const auto map = door_map(0.04, 1.0 / 600.0);
  for (const PatchMemory memory : {PatchMemory::kShared, PatchMemory::kPerParticle}) {
    const PatchStates states(map, {.memory = memory});
    ParticleSet particles = one_particle(states);
    EXPECT_NEAR(row_of(states, particles)[1], 0.04, 1e-6);
    EXPECT_NEAR(states.posterior(particles)[0].probability[1], 0.04, 1e-6);
  }
}

TEST(PatchRates, WhatWasSeenFadesToWhatIsUsual) {
  const auto map = door_map(0.04, 1.0 / 600.0);
  WorkerPool pool(1);
  for (const PatchMemory memory : {PatchMemory::kShared, PatchMemory::kPerParticle}) {
    const PatchStates states(map, {.memory = memory});
    ParticleSet particles = one_particle(states);
    const std::span<float> row = row_of(states, particles);
    row[0] = 0.0F;
    row[1] = 1.0F;
    states.predict(600.0, 1, 1, particles, pool);
    EXPECT_NEAR(row[1], std::exp(-1.0) + (1.0 - std::exp(-1.0)) * 0.04, 1e-6);
    states.predict(36000.0, 1, 2, particles, pool);
    EXPECT_NEAR(row[1], 0.04, 1e-6);
    EXPECT_NEAR(row[0] + row[1], 1.0, 1e-6);
  }
}

TEST(PatchRates, WithoutMemoryConfigurationsAreDrawnAsTheyUsuallyAre) {
  constexpr std::size_t kParticles = 20000;
  const auto map = door_map(0.1, 1.0 / 600.0);
  const PatchStates states(map, {.memory = PatchMemory::kNone});
  ParticleSet particles;
  particles.resize(kParticles);
  for (std::size_t i = 0; i < kParticles; ++i) particles.set_pose(i, {5.0, 1.5, 0.0});
  states.prepare(particles);
  WorkerPool pool(2);
  const auto open_share = [&] {
    double open = 0.0;
    for (const std::int32_t k : particles.configuration) open += k == 1 ? 1.0 : 0.0;
    return open / kParticles;
  };
  states.predict(1.0, 3, 1, particles, pool);
  EXPECT_NEAR(open_share(), 0.1, 0.01) << "on entering";
  particles.configuration.assign(kParticles, 1);
  states.predict(600.0, 3, 2, particles, pool);
  EXPECT_NEAR(open_share(), std::exp(-1.0) + (1.0 - std::exp(-1.0)) * 0.1, 0.015);
}

TEST(PatchRates, FixedOnesForgetToEvenOdds) {
  const auto map = door_map(0.04, 1.0);
  const PatchStates states(map, {.rates = RateSource::kFixed});
  EXPECT_EQ(states.rate_per_s(0), 1.0 / 600.0);
  ParticleSet particles = one_particle(states);
  EXPECT_EQ(particles.belief(0)[1], 0.5F);
  particles.belief(0)[0] = 0.0F;
  particles.belief(0)[1] = 1.0F;
  WorkerPool pool(1);
  states.predict(600.0, 1, 1, particles, pool);
  EXPECT_NEAR(particles.belief(0)[1], stay_probability(2, 1.0 / 600.0, 600.0), 1e-6);
}

TEST(PatchRates, OfMapsThatCameWithoutAreThoseOfTheirSequences) {
  auto map = empty_map();
  map->submaps.push_back(submap_of(0, {{10, 0}, {30, 40}}, {room(), room_with_box()}));
  map->submaps.push_back(submap_of(1, {{60, 0}, {80, 40}}, {room(), room_with_box()}));
  map->submaps[0].sequences = door(0.5, 1.0 / 600.0, 300.0, 600, 3);
  map->submaps[1].sequences = door(0.1, 1.0 / 7200.0, 3600.0, 600, 4);
  map->submaps[1].configurations[0].prior = 0.9;
  map->submaps[1].configurations[1].prior = 0.1;
  const PatchStates states(map, {});
  EXPECT_NEAR(600.0 * states.rate_per_s(0), 1.0, 0.25);
  EXPECT_NEAR(7200.0 * states.rate_per_s(1), 1.0, 0.25);
}

TEST(PatchRates, PriorsThatAreNoSharesAreEvenOdds) {
  for (const double damaged : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    auto map = door_map(0.1, 1.0);
    for (auto& configuration : map->submaps[0].configurations) configuration.prior = damaged;
    EXPECT_EQ(PatchStates(map, {}).usual()[1], 0.5F) << damaged;
  }
  // Nothing is impossible.
  EXPECT_NEAR(PatchStates(door_map(0.0, 1.0), {.min_belief = 0.01}).usual()[1], 0.01, 1e-3);
}

TEST(PatchRates, ANewConfigurationStartsAsItUsuallyIs) {
  const auto before = box_map();
  before->submaps[0].configurations.pop_back();
  const auto now = door_map(0.1, 1.0 / 600.0);
  const PatchStates old_states(before, {});
  const PatchStates states(now, {});
  ParticleSet particles = one_particle(old_states);
  states.adopt(&old_states, 1, 1, particles);
  EXPECT_NEAR(particles.belief(0)[0], 0.9, 1e-5);
  EXPECT_NEAR(particles.belief(0)[1], 0.1, 1e-5);
}

// What a sub-map was entered from when it was learned is what it is entered from.
TEST(PatchRates, AMapSaysFromWhereItsSubmapsAreEntered) {
  auto map = box_map();
  const CellRect& rect = map->submaps[0].rect;
  const Eigen::Vector2d beside_m{(rect.min.x - 6) * 0.05, 0.05 * (rect.min.y + 10)};
  EXPECT_EQ(PatchStates(map, {.memory = PatchMemory::kNone}).submap_of(beside_m), 0);
  map->entry_margin_m = 0.2;
  EXPECT_EQ(PatchStates(map, {.memory = PatchMemory::kNone}).submap_of(beside_m), -1);
}

}  // namespace
}  // namespace strata::localization
