// SPDX-License-Identifier: Apache-2.0
// How fast what is known of a sub-map becomes unknown.
#include <cmath>
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

/// A sub-map whose sequences follow a chain of the given rate, `count` of them, dt apart.
patch::Submap chain(int configurations, double gamma_per_s, double dt_s, int count,
                    std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  patch::Submap submap;
  submap.configurations.resize(static_cast<std::size_t>(configurations));
  std::size_t state = 0;
  for (int i = 0; i < count; ++i) {
    if (!random.bernoulli(stay_probability(configurations, gamma_per_s, dt_s))) {
      const auto others = static_cast<std::uint32_t>(configurations - 1);
      state = (state + 1 + random.below(others)) % static_cast<std::size_t>(configurations);
    }
    patch::SequenceInfo sequence;
    sequence.begin = Stamp::from_seconds(i * (dt_s + 10.0));
    sequence.end = Stamp::from_seconds(i * (dt_s + 10.0) + 10.0);
    sequence.membership.assign(static_cast<std::size_t>(configurations), 0.0);
    sequence.membership[state] = 1.0;
    submap.sequences.push_back(sequence);
  }
  return submap;
}

TEST(PatchRates, AreThoseOfTheChainThatMadeTheSequences) {
  PatchStatesConfig config;
  for (const int configurations : {2, 4}) {
    for (const double gamma : {1.0 / 600.0, 1.0 / 7200.0}) {
      const double learned =
          learned_rate_per_s(chain(configurations, gamma, 0.5 / gamma, 600, 11), config);
      EXPECT_NEAR(learned / gamma, 1.0, 0.2) << configurations << " " << gamma;
    }
  }
}

TEST(PatchRates, BeliefsOfEachSubmapFadeAtItsOwn) {
  auto map = empty_map();
  map->submaps.push_back(submap_of(0, {{10, 0}, {30, 40}}, {room(), room_with_box()}));
  map->submaps.push_back(submap_of(1, {{60, 0}, {80, 40}}, {room(), room_with_box()}));
  map->submaps[0].sequences = chain(2, 1.0 / 600.0, 300.0, 200, 3).sequences;
  map->submaps[1].sequences = chain(2, 1.0 / 36000.0, 18000.0, 200, 4).sequences;
  WorkerPool pool(1);
  for (const PatchMemory memory : {PatchMemory::kShared, PatchMemory::kPerParticle}) {
    PatchStatesConfig config;
    config.memory = memory;
    config.rates = RateSource::kLearned;
    const PatchStates states(map, config);
    ASSERT_GT(states.rate_per_s(0), 5.0 * states.rate_per_s(1));
    ParticleSet particles;
    particles.resize(1);
    set_uniform_weights(particles);
    states.prepare(particles);
    const std::span<float> row = memory == PatchMemory::kShared
                                     ? std::span<float>(particles.shared_belief)
                                     : particles.belief(0);
    for (std::size_t s = 0; s < 2; ++s) {
      row[states.offset(s)] = 1.0F;
      row[states.offset(s) + 1] = 0.0F;
    }
    states.predict(600.0, 1, 1, particles, pool);
    for (std::size_t s = 0; s < 2; ++s) {
      const double stayed = stay_probability(2, states.rate_per_s(s), 600.0);
      EXPECT_NEAR(row[states.offset(s)], stayed, 1e-6) << s;
      EXPECT_NEAR(row[states.offset(s) + 1], 1.0 - stayed, 1e-6) << s;
    }
  }
}

TEST(PatchRates, WithoutSequencesTheyAreThePrior) {
  PatchStatesConfig config;
  config.prior_changes = 2.0;
  config.prior_hours = 1.0;
  EXPECT_NEAR(learned_rate_per_s(chain(3, 0.1, 1.0, 0, 1), config), 2.0 / 3600.0, 1e-6);
  // Runs whose stamps overlap say nothing of the time between.
  patch::Submap overlapping = chain(2, 0.1, 1.0, 2, 1);
  overlapping.sequences[1].begin = overlapping.sequences[0].begin;
  EXPECT_NEAR(learned_rate_per_s(overlapping, config), 2.0 / 3600.0, 1e-6);
}

TEST(PatchRates, APlaceThatNeverChangesIsRememberedLonger) {
  auto map = box_map();
  map->submaps[0].sequences = chain(2, 1e-9, 3600.0, 50, 3).sequences;
  PatchStatesConfig config;
  config.rates = RateSource::kLearned;
  const PatchStates steady(map, config);
  map->submaps[0].sequences = chain(2, 1.0, 3600.0, 50, 3).sequences;
  const PatchStates fickle(map, config);
  EXPECT_LT(steady.rate_per_s(0), 0.1 / 3600.0);
  EXPECT_GT(fickle.rate_per_s(0), 1.0 / 3600.0);
}

}  // namespace
}  // namespace strata::localization
