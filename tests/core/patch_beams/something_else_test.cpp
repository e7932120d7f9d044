// SPDX-License-Identifier: Apache-2.0
/// What stands in an area may be nothing that was seen there (docs/theory/patch_localization.md,
/// "Something else").
#include "core/patch_beams/something_else.hpp"

#include <cmath>
#include <memory>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "core/patch/recurrence.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::patch_beams {
namespace {

using localization::ParticleSet;
using localization::PatchMemory;
using localization::PatchStates;
using localization::PatchStatesConfig;
using localization::RateSource;

/// A box that nobody saw return.
constexpr const char* kNeverBack = "aab";
/// ... and one that came and went.
constexpr const char* kBack = "abababababab";

patch::Submap seen(patch::Submap submap, const std::string& kinds) {
  const std::size_t configurations = submap.configurations.size();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    patch::SequenceInfo sequence;
    sequence.begin = Stamp::from_seconds(3600.0 * static_cast<double>(i));
    sequence.end = Stamp::from_seconds(3600.0 * static_cast<double>(i) + 10.0);
    sequence.membership.assign(configurations, 0.0);
    sequence.membership[static_cast<std::size_t>(kinds[i] - 'a')] = 1.0;
    submap.sequences.push_back(sequence);
  }
  return submap;
}

std::shared_ptr<const patch::PatchMap> map_seen(const std::string& kinds) {
  auto map = test::box_map();
  map->submaps[0] = seen(map->submaps[0], kinds);
  return map;
}

ParticleSet particles_in(const PatchStates& states, std::size_t count) {
  ParticleSet particles;
  particles.resize(count);
  states.prepare(particles);
  for (std::size_t i = 0; i < count; ++i) {
    RandomStream random(1, StreamId::kTest, 0, static_cast<std::uint32_t>(i));
    particles.set_pose(i, {2.0 + 0.01 * static_cast<double>(i % 200), 2.0, 0.0});
    states.draw(particles, i, random);
  }
  localization::set_uniform_weights(particles);
  return particles;
}

TEST(SomethingElse, IsExpectedWhereLittleReturned) {
  const double never = localization::shares_of_something_else(*map_seen(kNeverBack))[0];
  const double back = localization::shares_of_something_else(*map_seen(kBack))[0];
  // One appearance had no chance to be a return: p = 2 / 3. Six had five, all taken.
  EXPECT_NEAR(never, (1.0 - 2.0 / 3.0) * 0.5 * std::exp(-3.0), 1e-9);
  EXPECT_NEAR(back, (1.0 - (5.0 + 7.0 / 8.0) / 6.0) * 0.5 * std::exp(-3.0), 1e-9);
  EXPECT_EQ(localization::shares_of_something_else(*test::box_map())[0], 0.0)
      << "nobody knows what came back";
}

TEST(SomethingElse, TakesItsShareOfWhatIsUsualWithABeliefForEachParticleOnly) {
  const auto map = map_seen(kNeverBack);
  const PatchStates states(map, {});
  ASSERT_TRUE(states.expects_something_else());
  const double usual = static_cast<double>(states.usual()[0] + states.usual()[1]);
  EXPECT_NEAR(usual, 1.0 - static_cast<double>(states.something_else(0)), 1e-6);
  EXPECT_LT(usual, 0.995);
  for (const PatchStatesConfig& config : {PatchStatesConfig{.memory = PatchMemory::kNone},
                                          PatchStatesConfig{.memory = PatchMemory::kShared},
                                          PatchStatesConfig{.rates = RateSource::kFixed}}) {
    const PatchStates none(map, config);
    EXPECT_FALSE(none.expects_something_else());
    EXPECT_NEAR(static_cast<double>(none.usual()[0] + none.usual()[1]), 1.0, 1e-6);
  }
}

TEST(SomethingElse, FadesBackToItsShareAndIsLeftInThePosterior) {
  const PatchStates states(map_seen(kNeverBack), {});
  ParticleSet particles = particles_in(states, 40);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.belief(i)[0] = 0.3F;
    particles.belief(i)[1] = 0.1F;
  }
  const auto now = states.posterior(particles)[0].probability;
  EXPECT_NEAR(now[0], 0.3, 1e-6);
  EXPECT_NEAR(now[1], 0.1, 1e-6);
  WorkerPool pool(1);
  states.predict(1e9, 1, 1, particles, pool);
  const auto then = states.posterior(particles)[0].probability;
  EXPECT_NEAR(1.0 - then[0] - then[1], static_cast<double>(states.something_else(0)), 1e-6);
}

/// Two chunks of three particles. In the first, one particle's beams fit the box by `gain`, and
/// another's do, less likely by 30.
std::vector<SubmapRatios> ratios_with(double gain) {
  std::vector<SubmapRatios> ratios(2);
  for (SubmapRatios& chunk : ratios) chunk.begin(1, 3);
  for (const std::size_t particle : {0U, 2U}) {
    const std::size_t row = ratios[0].meet(0, 3, particle);
    ratios[0].at(row + 1, particle) = particle == 0 ? gain : 500.0;
  }
  return ratios;
}

TEST(SomethingElse, ExplainsAScanAlikeAtAllPosesAndNearlyAsWellAsTheBestThatIsLikely) {
  const PatchStates states(map_seen(kNeverBack), {});
  const std::vector<double> weight(6, 1.0 / 6.0);
  const std::vector<double> log_likelihood{0.0, 0.0, -1000.0, 0.0, 0.0, 0.0};
  auto ratios = ratios_with(60.0);
  SomethingElse something_else;
  something_else.explain(states, 2.0, weight, log_likelihood, 3, ratios);
  for (SubmapRatios& chunk : ratios) {
    ASSERT_NE(chunk.find(0), nullptr);
    const std::size_t row = chunk.find(0)->row;
    for (std::size_t n = 0; n < 3; ++n) {
      EXPECT_TRUE(chunk.is_met(0, n));
      EXPECT_NEAR(chunk.at(row + 2, n), 2.0 * (30.0 - 2.0), 1e-9);
      EXPECT_EQ(chunk.at(row, n), 0.0);
    }
  }
  auto little = ratios_with(3.0);  // 1.5 nats: less than a surprise costs
  something_else.explain(states, 2.0, weight, log_likelihood, 3, little);
  // Four particles that gain nothing are likely, too.
  const double gain = 1.5 * std::exp(1.5) / (std::exp(1.5) + 4.0);
  for (SubmapRatios& chunk : little) EXPECT_NEAR(chunk.at(2, 1), 2.0 * (gain - 2.0), 1e-9);
  std::vector<SubmapRatios> unmet(2);
  for (SubmapRatios& chunk : unmet) chunk.begin(1, 3);
  something_else.explain(states, 2.0, weight, log_likelihood, 3, unmet);
  EXPECT_EQ(unmet[0].find(0), nullptr) << "nobody looked";
}

const CellRect kCorridor{{0, 0}, {800, 60}};  // 40 m x 3 m

/// Plain: nothing but the box says where along it a robot is.
test::BoxWorld corridor() { return {{0.0, 0.0, 40.0, 0.4}, {0.0, 2.6, 40.0, 3.0}}; }
test::BoxWorld corridor_with_box(double x_m) {
  test::BoxWorld world = corridor();
  world.push_back({x_m, 0.4, x_m + 0.6, 1.0});
  return world;
}

/// Its box was seen at 20 m, and at times nowhere.
std::shared_ptr<const patch::PatchMap> corridor_seen(const std::string& kinds) {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = test::rasterize(corridor(), 0.05, kCorridor);
  patch::Submap submap;
  submap.rect = {{380, 0}, {430, 60}};
  for (const test::BoxWorld& world : {corridor(), corridor_with_box(20.0)}) {
    patch::Configuration configuration;
    configuration.reflection = test::rasterize(world, 0.05, kCorridor).cropped(submap.rect);
    configuration.prior = 0.5;
    submap.configurations.push_back(configuration);
  }
  map->submaps.push_back(seen(submap, kinds));
  return map;
}

struct Weighed {
  std::vector<double> sum;  ///< of the log-likelihoods of all scans
  ParticleSet particles;
  [[nodiscard]] double left(std::size_t i) const {
    return localization::left_of(particles.belief(i));
  }
};

/// From 18 m where the box stands `shift_m` further on than where it was seen. Particles stand 1 cm
/// from each other, number 100 where the robot is, 60 where the box would be the known one if it is
/// 0.4 m further on.
Weighed weigh(const std::string& kinds, std::size_t count, int threads, double shift_m,
              bool is_place_sure = true) {
  const PatchBeamModel model(corridor_seen(kinds), {});
  Weighed weighed;
  weighed.particles = particles_in(*model.patch_states(), count);
  for (std::size_t i = 0; i < count; ++i) {
    weighed.particles.set_pose(i, {17.0 + 0.01 * static_cast<double>(i % 200), 1.5, 0.0});
  }
  weighed.sum.assign(count, 0.0);
  std::vector<double> log_likelihood(count);
  WorkerPool pool(threads);
  test::Drive drive({18.0, 1.5, 0.0}, 12);
  for (int n = 0; n < 5; ++n) {
    const Scan scan = drive.look(corridor_with_box(20.0 + shift_m)).scan;
    const localization::Weighing weighing{.tempering = model.tempering(),
                                          .is_place_sure = is_place_sure};
    model.log_likelihoods(scan, weighing, weighed.particles, log_likelihood, pool);
    for (std::size_t i = 0; i < count; ++i) weighed.sum[i] += log_likelihood[i];
  }
  return weighed;
}

TEST(SomethingElse, IsBelievedAtThePoseAtWhichNothingKnownFits) {
  const Weighed moved = weigh(kNeverBack, 200, 1, 0.4);
  EXPECT_GT(moved.left(100), 0.9);
  EXPECT_LT(moved.left(60), 0.1);
  const Weighed known = weigh(kNeverBack, 200, 1, 0.0);
  EXPECT_LT(known.left(100), 0.1) << "the box is where it was";
  const double share = localization::shares_of_something_else(*corridor_seen(kNeverBack))[0];
  EXPECT_GT(known.left(100), 0.9 * share) << "something may come at any time";
}

TEST(SomethingElse, KeepsABoxThatIsTakenForAKnownOneFromPullingThePose) {
  const auto pull = [](const std::string& kinds) {
    const Weighed weighed = weigh(kinds, 200, 1, 0.4);
    return weighed.sum[60] - weighed.sum[100];
  };
  const double without = pull("");
  const double with = pull(kNeverBack);
  EXPECT_GT(without, 20.0);
  EXPECT_LT(with, 18.0) << "a surprise a scan, and what it costs at first";
  EXPECT_GT(with, 5.0) << "what is known is still believed sooner";
  EXPECT_LT(with, pull(kBack)) << "the sooner, the more it returned";
}

TEST(SomethingElse, ExcusesNoPlaceBeforeOneIsSure) {
  const auto pull = [](const Weighed& weighed) { return weighed.sum[60] - weighed.sum[100]; };
  const Weighed unsure = weigh(kNeverBack, 200, 1, 0.4, false);
  EXPECT_NEAR(pull(unsure), pull(weigh("", 200, 1, 0.4)), 0.5) << "the pull of what is known";
  EXPECT_GT(pull(unsure), pull(weigh(kNeverBack, 200, 1, 0.4)) + 2.0);
  EXPECT_NEAR(unsure.left(100), 0.0, 1e-6);
}

TEST(SomethingElse, IsTheSameBitsWithAnyNumberOfThreads) {
  const Weighed one = weigh(kNeverBack, 700, 1, 0.4);
  for (const int threads : {2, 8}) {
    const Weighed more = weigh(kNeverBack, 700, threads, 0.4);
    EXPECT_EQ(one.sum, more.sum);
    EXPECT_EQ(one.particles.beliefs, more.particles.beliefs);
  }
}

}  // namespace
}  // namespace strata::patch_beams
