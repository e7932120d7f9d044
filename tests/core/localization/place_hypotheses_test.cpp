// SPDX-License-Identifier: Apache-2.0
#include "core/localization/place_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

/// A corridor of which only a pillar tells one part from the next.
BoxWorld corridor() {
  return {{0.0, 0.0, 24.0, 0.4},
          {0.0, 2.6, 24.0, 3.0},
          {0.0, 0.0, 0.4, 3.0},
          {23.6, 0.0, 24.0, 3.0},
          {8.0, 0.4, 8.8, 1.1}};
}

/// The same when turned round.
BoxWorld turned_room() {
  return {{0.0, 0.0, 6.0, 0.4}, {0.0, 3.6, 6.0, 4.0}, {0.0, 0.0, 0.4, 4.0},
          {5.6, 0.0, 6.0, 4.0}, {1.0, 0.4, 1.6, 1.3}, {4.4, 2.7, 5.0, 3.6}};
}

LocalizerConfig searching() {
  LocalizerConfig config;
  config.global_search.is_used = true;
  return config;
}

TEST(PlaceHypotheses, AreSeveralInAPlainCorridorUntilAMarkComesInSight) {
  const BoxWorld world = corridor();
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {480, 60}});
  const auto model = make_grid_beam_model(map);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Drive drive({13.0, 1.6, 3.1}, 60 + seed);
    Localizer localizer(searching(), model, seed, 2);
    localizer.initialize_global(map);
    bool is_decided = false;
    for (int n = 0; n < 70; ++n) {
      drive.step({0.12, 0.0, 0.0});
      const LocalizationResult result = localizer.update(drive.look(world, 4.0, 60));
      if (n == 0) {
        EXPECT_TRUE(result.is_ambiguous) << seed;
        EXPECT_GT(result.places.size(), 4U) << seed;
        EXPECT_FALSE(result.converged) << seed;
      }
      if (result.is_ambiguous) continue;
      is_decided = true;
      EXPECT_TRUE(result.places.empty());
      EXPECT_LT(translation_distance(result.pose.mean, drive.truth()), 0.5) << seed << ", " << n;
    }
    EXPECT_TRUE(is_decided) << seed;
  }
}

TEST(PlaceHypotheses, AreNotToldOfBeforeAnyWasFound) {
  const BoxWorld world = corridor();
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {480, 60}});
  LocalizerConfig config = searching();
  config.global_search.search.max_candidates = 3;  // more fit, so it waits for more scans
  config.global_search.patience = 4;
  Localizer localizer(config, make_grid_beam_model(map), 4, 1);
  localizer.initialize_global(map);
  Drive drive({16.0, 1.6, 3.1}, 61);
  for (int n = 0; n < 8; ++n) {
    drive.step({0.12, 0.0, 0.0});
    const LocalizationResult result = localizer.update(drive.look(world, 4.0, 60));
    EXPECT_TRUE(result.is_ambiguous) << n;
    EXPECT_EQ(result.places.empty(), n < 4) << n;
  }
}

TEST(PlaceHypotheses, AreNeverDecidedWhereTwoPlacesLookAlike) {
  const BoxWorld world = turned_room();
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {120, 80}});
  Localizer localizer(searching(), make_grid_beam_model(map), 4, 2);
  localizer.initialize_global(map);
  Drive drive({2.2, 2.2, 0.4}, 64);
  LocalizationResult result;
  for (int n = 0; n < 40; ++n) {
    drive.step({0.02, 0.0, 0.12});
    result = localizer.update(drive.look(world, 8.0, 60));
    EXPECT_TRUE(result.is_ambiguous) << n;
    EXPECT_FALSE(result.converged) << n;
  }
  ASSERT_EQ(result.places.size(), 2U);
  const Pose2 turned{6.0 - drive.truth().x, 4.0 - drive.truth().y, drive.truth().theta};
  for (const Pose2& truth : {drive.truth(), turned}) {
    EXPECT_LT(std::min(translation_distance(result.places[0].map_from_robot, truth),
                       translation_distance(result.places[1].map_from_robot, truth)),
              0.2);
  }
  EXPECT_NEAR(result.places[0].probability + result.places[1].probability, 1.0, 1e-6);
}

TEST(PlaceHypotheses, ShareTheScoreThatOneOfThemHadAlone) {
  const BoxWorld world = turned_room();
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {120, 80}});
  const auto model = make_grid_beam_model(map);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Localizer localizer(searching(), model, seed, 2);
    localizer.initialize_global(map);
    Drive drive({2.2, 2.2, 0.4}, 64 + seed);
    LocalizationResult result;
    for (int n = 0; n < 60; ++n) {
      drive.step({0.02, 0.0, 0.12});
      result = localizer.update(drive.look(world, 8.0, 60));
      const bool is_several = result.places.size() > 1;
      const double share = is_several ? result.places[0].probability : 1.0;
      EXPECT_NEAR(result.score, share * result.place_score, 1e-9) << seed << ", " << n;
    }
    ASSERT_EQ(result.places.size(), 2U) << seed;
    EXPECT_GT(result.place_score, 0.8) << seed;
    EXPECT_LT(result.score, 0.8) << seed;
  }
}

TEST(PlaceHypotheses, AreGivenUpForAPoseThatIsGiven) {
  const BoxWorld world = turned_room();
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {120, 80}});
  Localizer localizer(searching(), make_grid_beam_model(map), 4, 1);
  localizer.initialize_global(map);
  Drive drive({2.2, 2.2, 0.4}, 64);
  ASSERT_TRUE(localizer.update(drive.look(world, 8.0, 60)).is_ambiguous);
  localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  const LocalizationResult result = localizer.update(drive.look(world, 8.0, 60));
  EXPECT_FALSE(result.is_ambiguous);
  EXPECT_TRUE(result.places.empty());
  EXPECT_LT(translation_distance(result.pose.mean, drive.truth()), 0.2);
}

TEST(PlaceHypotheses, GiveTheSameBitsWhateverTheNumberOfThreads) {
  const BoxWorld world = corridor();
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {480, 60}});
  const auto model = make_grid_beam_model(map);
  std::vector<std::vector<double>> x;
  for (const int threads : {1, 2, 5}) {
    Drive drive({13.0, 1.6, 3.1}, 61);
    Localizer localizer(searching(), model, 3, threads);
    localizer.initialize_global(map);
    for (int n = 0; n < 10; ++n) {
      drive.step({0.12, 0.0, 0.0});
      localizer.update(drive.look(world, 4.0, 60));
    }
    x.push_back(localizer.particles().x_m);
  }
  EXPECT_EQ(x[1], x[0]);
  EXPECT_EQ(x[2], x[0]);
}

TEST(PlaceHypotheses, AreLookedForWhenThePoseIsInDoubt) {
  const BoxWorld world = {{0.0, 0.0, 12.0, 0.4},  {0.0, 5.6, 12.0, 6.0}, {0.0, 0.0, 0.4, 6.0},
                          {11.6, 0.0, 12.0, 6.0}, {2.0, 0.4, 2.6, 1.3},  {7.0, 4.0, 8.2, 5.6},
                          {9.0, 1.5, 9.4, 2.4}};
  const ReflectionGrid map = test::rasterize(world, 0.05, {{0, 0}, {240, 120}});
  LocalizerConfig config = searching();
  config.recovery.restart_after = 5;
  config.global_search.watch.is_used = false;  // nobody else looks
  Localizer localizer(config, make_grid_beam_model(map), 4, 2);
  localizer.set_free_space(map);
  Drive drive({3.0, 2.5, 0.0}, 65);
  localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  for (int n = 0; n < 20; ++n) {
    drive.step({0.1, 0.0, 0.02});
    EXPECT_FALSE(localizer.update(drive.look(world, 8.0, 60)).is_recovering);
  }
  ASSERT_LT(weighted_error(localizer.particles(), drive.truth()), 0.2);
  drive.kidnap({9.8, 4.6, -2.0});
  bool was_elsewhere = false;
  bool was_recovering = false;
  for (int n = 0; n < 50; ++n) {  // 10 s
    drive.step({0.05, 0.0, 0.02});
    was_recovering |= localizer.update(drive.look(world, 8.0, 60)).is_recovering;
    was_elsewhere |= weighted_error(localizer.particles(), drive.truth()) > 3.0;
  }
  EXPECT_TRUE(was_elsewhere);
  EXPECT_TRUE(was_recovering);
  EXPECT_LT(weighted_error(localizer.particles(), drive.truth()), 0.3);
}

}  // namespace
}  // namespace strata::localization
