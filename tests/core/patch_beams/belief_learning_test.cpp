// SPDX-License-Identifier: Apache-2.0
/// Beliefs are learned in columns, and of one row in update_belief: the same bits.
#include "core/patch_beams/belief_learning.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/rays/column_math.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::patch_beams {
namespace {

using localization::ParticleSet;
using localization::PatchStates;
using test::room;
using test::room_with_box;
using test::submap_of;

constexpr std::size_t kParticles = 21;
constexpr double kTempering = 2.0;

struct Learned {
  ParticleSet before;
  ParticleSet after;
  SubmapRatios ratios;  // as they were
};

Learned learn(const PatchStates& states, RandomStream& random) {
  Learned learned;
  ParticleSet& particles = learned.before;
  particles.resize(kParticles);
  states.prepare(particles);
  for (std::size_t i = 0; i < kParticles; ++i) {
    particles.submap[i] = static_cast<std::int32_t>(random.below(3)) - 1;
    for (float& b : particles.belief(i)) {
      b = random.bernoulli(0.1) ? 0.0F : static_cast<float>(random.uniform());
    }
  }
  learned.ratios.begin(2, kParticles);
  for (const std::size_t submap : {1U, 0U}) {
    const auto count = static_cast<std::size_t>(states.count(submap));
    for (std::size_t i = 0; i < kParticles; ++i) {
      if (random.bernoulli(0.2)) continue;
      const std::size_t row = learned.ratios.meet(submap, count, i);
      for (std::size_t k = 0; k < count; ++k) {
        learned.ratios.at(row + k, i) = random.normal(0.0, random.bernoulli(0.2) ? 3000.0 : 3.0);
      }
    }
  }
  learned.after = particles;
  SubmapRatios used = learned.ratios;
  std::vector<double> log_likelihood(kParticles, 0.0);
  BeliefColumns columns;
  learn_beliefs(states, kTempering, 0, log_likelihood, used, learned.after, columns);
  return learned;
}

/// The factors of update_belief, in the rows of the ratios.
std::vector<double> factors_of(Learned& learned) {
  SubmapRatios& ratios = learned.ratios;
  for (double& value : ratios.values()) value *= 1.0 / kTempering;
  for (const SubmapRatios::Met& met : ratios.met()) {
    for (std::size_t i = 0; i < kParticles; ++i) {
      double largest = ratios.at(met.row, i);
      for (std::size_t k = 1; k < met.configurations; ++k) {
        largest = std::max(largest, ratios.at(met.row + k, i));
      }
      for (std::size_t k = 0; k < met.configurations; ++k) ratios.at(met.row + k, i) -= largest;
    }
  }
  std::vector<double> factors = ratios.values();
  rays::exp_column(factors.data(), factors.size());
  return factors;
}

TEST(BeliefLearning, InColumnsGivesTheBitsOfUpdateBelief) {
  auto map = test::empty_map();
  map->submaps.push_back(submap_of(0, {{10, 0}, {30, 40}}, {room(), room_with_box()}));
  map->submaps.push_back(submap_of(1, {{60, 0}, {80, 40}}, {room(), room_with_box(), room()}));
  const PatchStates states(map, {});
  std::size_t learned_rows = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    RandomStream random(seed, StreamId::kTest);
    Learned learned = learn(states, random);
    const std::vector<double> factors = factors_of(learned);
    for (std::size_t place = 0; place < learned.ratios.met().size(); ++place) {
      const SubmapRatios::Met& met = learned.ratios.met()[place];
      for (std::size_t i = 0; i < kParticles; ++i) {
        const auto belief_of = [&](ParticleSet& particles) {
          return particles.belief(i).subspan(states.offset(met.submap), met.configurations);
        };
        std::vector<float> expected(belief_of(learned.before).begin(),
                                    belief_of(learned.before).end());
        std::vector<double> factor;
        for (std::size_t k = 0; k < met.configurations; ++k) {
          factor.push_back(factors[(met.row + k) * kParticles + i]);
        }
        if (learned.ratios.is_met(place, i)) {
          localization::update_belief(expected, factor, states.min_belief());
          ++learned_rows;
        }
        const std::span<const float> got = belief_of(learned.after);
        EXPECT_TRUE(std::equal(expected.begin(), expected.end(), got.begin()))
            << "seed " << seed << " sub-map " << met.submap << " particle " << i;
      }
    }
  }
  EXPECT_GT(learned_rows, 1000U);
}

}  // namespace
}  // namespace strata::patch_beams
