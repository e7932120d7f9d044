// SPDX-License-Identifier: Apache-2.0
/// The search beside a pose that is doubted. Of places that look alike:
/// watch_alike_places_test.cpp; where the map ends: watch_beyond_map_test.cpp.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

const BoxWorld kRoom = {{0.0, 0.0, 12.0, 0.4},  {0.0, 5.6, 12.0, 6.0}, {0.0, 0.0, 0.4, 6.0},
                        {11.6, 0.0, 12.0, 6.0}, {2.0, 0.4, 2.6, 1.3},  {7.0, 4.0, 8.2, 5.6},
                        {9.0, 1.5, 9.4, 2.4}};
/// Larger, and furnished otherwise: nowhere in the map is like it.
const BoxWorld kOtherRoom = {{0.0, 0.0, 14.2, 0.4},  {0.0, 7.0, 14.2, 7.4}, {0.0, 0.0, 0.4, 7.4},
                             {13.8, 0.0, 14.2, 7.4}, {1.0, 5.0, 3.0, 7.0},  {4.6, 2.5, 5.4, 3.4}};

ReflectionGrid map_of_room() { return test::rasterize(kRoom, 0.05, {{0, 0}, {240, 120}}); }

Localizer watched(const ReflectionGrid& map, bool is_used, int threads = 1) {
  LocalizerConfig config;
  config.global_search.watch.is_used = is_used;
  Localizer localizer(config, make_grid_beam_model(map), 4, threads);
  localizer.set_free_space(map);
  localizer.initialize({{3.0, 2.5, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  return localizer;
}

/// Tracked for 20 scans, then carried to the other end of the room. truth: at the last scan.
std::vector<Observation> carried_away(int scans_there, Pose2* truth = nullptr) {
  std::vector<Observation> seen;
  Drive drive({3.0, 2.5, 0.0}, 65);
  for (int n = 0; n < 20 + scans_there; ++n) {
    if (n == 20) drive.kidnap({9.8, 4.6, -2.0});
    drive.step({n < 20 ? 0.1 : 0.05, 0.0, 0.02});
    seen.push_back(drive.look(kRoom, 8.0, 60));
  }
  if (truth != nullptr) *truth = drive.truth();
  return seen;
}

TEST(LocalizerWatch, FindsARobotThatWasCarriedAwayAndIsNotSureMeanwhile) {
  const ReflectionGrid map = map_of_room();
  for (const bool is_used : {false, true}) {
    Localizer localizer = watched(map, is_used);
    Drive drive({3.0, 2.5, 0.0}, 65);
    bool was_ambiguous = false;
    bool was_recovering = false;
    double error_m = 0.0;
    for (int n = 0; n < 90; ++n) {
      if (n == 20) drive.kidnap({9.8, 4.6, -2.0});
      drive.step({n < 20 ? 0.1 : 0.05, 0.0, 0.02});
      const LocalizationResult result = localizer.update(drive.look(kRoom, 8.0, 60));
      error_m = translation_distance(result.pose.mean, drive.truth());
      if (n < 20) {
        EXPECT_LT(error_m, 0.3);
        EXPECT_FALSE(result.is_ambiguous || result.is_recovering);
      }
      was_ambiguous |= result.is_ambiguous;
      if (was_recovering && !result.is_recovering) {
        EXPECT_LT(error_m, 0.5) << "the search ended before it found";
      }
      was_recovering |= result.is_recovering;
      EXPECT_EQ(result.is_ambiguous, !result.places.empty()) << n;
    }
    EXPECT_EQ(error_m < 0.3, is_used) << error_m;
    EXPECT_TRUE(is_used || !was_ambiguous);
    EXPECT_EQ(was_recovering, is_used);
  }
}

/// With a sub-map whose other configuration has a box more.
std::shared_ptr<const SensorModel> patch_model() {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = map_of_room();
  BoxWorld other = kRoom;
  other.push_back({5.0, 1.0, 5.6, 1.6});
  map->submaps.push_back(test::submap_of(0, {{80, 0}, {130, 60}}, {kRoom, other}));
  return std::make_shared<patch_beams::PatchBeamModel>(map, patch_beams::PatchBeamModelConfig{});
}

// As of somebody who maps, once a second: the same to the bit, or by models of other kinds.
TEST(LocalizerWatch, FindsARobotThatWasCarriedAwayWhileMapsCome) {
  const ReflectionGrid map = map_of_room();
  const ReflectionGrid grown = test::rasterize(kRoom, 0.05, {{-20, -20}, {260, 140}});
  for (const bool are_other : {false, true}) {
    Localizer localizer = watched(map, true);
    Pose2 truth;
    const std::vector<Observation> seen = carried_away(100, &truth);
    std::optional<double> relocated_m;
    for (std::size_t n = 0; n < seen.size(); ++n) {
      if (n % 5 == 0) {
        const bool is_other = are_other && n % 10 == 0;
        localizer.set_model(is_other ? patch_model() : make_grid_beam_model(map));
        localizer.set_free_space(is_other ? grown : map);
      }
      const LocalizationResult& result = localizer.update(seen[n]);
      if (result.relocated_m) relocated_m = result.relocated_m;
    }
    EXPECT_TRUE(relocated_m) << "nothing was found, of other maps: " << are_other;
    EXPECT_LT(translation_distance(localizer.result().pose.mean, truth), 0.3) << are_other;
  }
}

TEST(LocalizerWatch, LeavesAPoseInDoubtAndItsSearchAsTheyAreWhenAMapComes) {
  const ReflectionGrid map = map_of_room();
  Localizer with = watched(map, true);
  Localizer without = watched(map, true);
  std::size_t contested = 0;
  for (const Observation& observation : carried_away(60)) {
    with.set_model(make_grid_beam_model(map));
    with.set_free_space(map);
    const LocalizationResult& result = with.update(observation);
    const LocalizationResult& expected = without.update(observation);
    ASSERT_EQ(result.is_ambiguous, expected.is_ambiguous);
    ASSERT_EQ(result.relocated_m, expected.relocated_m);
    ASSERT_EQ(result.pose.mean, expected.pose.mean);
    contested += result.is_ambiguous ? 1 : 0;
  }
  EXPECT_GT(contested, 2U) << "nothing was doubted";
}

TEST(LocalizerWatch, TellsBothPlacesWhileTheOtherIsLikelierAndNotConfirmed) {
  const ReflectionGrid map = map_of_room();
  LocalizerConfig config;
  config.global_search.confirmation.confirmed_score = 1.0;  // never
  Localizer localizer(config, make_grid_beam_model(map), 4, 1);
  localizer.set_free_space(map);
  Drive drive({3.0, 2.5, 0.0}, 65);
  localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  std::size_t contested = 0;
  for (int n = 0; n < 60; ++n) {
    if (n == 20) drive.kidnap({9.8, 4.6, -2.0});
    drive.step({n < 20 ? 0.1 : 0.05, 0.0, 0.02});
    const LocalizationResult result = localizer.update(drive.look(kRoom, 8.0, 60));
    if (!result.is_ambiguous) continue;
    ++contested;
    ASSERT_GE(result.places.size(), 2U);
    double sum = 0.0;
    for (const PlaceBelief& place : result.places) sum += place.probability;
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_GT(result.places.front().probability, 0.3);
    EXPECT_LT(translation_distance(result.places.front().map_from_robot, drive.truth()), 0.5);
    EXPECT_EQ(result.places.back().map_from_robot, result.pose.mean) << "the pose stays its own";
    EXPECT_GT(translation_distance(result.pose.mean, drive.truth()), 1.0);
    EXPECT_FALSE(result.converged);
    EXPECT_NE(result.health.state, HealthState::kGood);
  }
  EXPECT_GT(contested, 10U);
}

TEST(LocalizerWatch, KeepsTheScansOfWhichThePoseIsDoubtedForTheSearch) {
  const ReflectionGrid map = map_of_room();
  Localizer with = watched(map, true);
  Localizer without = watched(map, false);
  std::vector<std::size_t> kept;  // bytes
  for (const Observation& observation : carried_away(12)) {
    (void)with.update(observation);
    (void)without.update(observation);
    kept.push_back(with.saved_state()->size() - without.saved_state()->size());
  }
  EXPECT_EQ(kept[19], 0U) << "before it was carried away";
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  EXPECT_GE(kept.size(), 4U) << "none, one scan, two, three";
}

TEST(LocalizerWatch, LeavesAPoseThatFitsAgainToTheFilterThatHasIt) {
  const ReflectionGrid map = map_of_room();
  LocalizerConfig config;
  config.global_search.watch.trusted_score = 1.0;  // the search goes on
  Localizer with(config, make_grid_beam_model(map), 4, 1);
  Localizer without = watched(map, false);
  with.set_free_space(map);
  with.initialize({{3.0, 2.5, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  Drive drive({3.0, 2.5, 0.0}, 67);
  std::size_t searched = 0;
  for (int n = 0; n < 80; ++n) {
    drive.step({0.03, 0.0, 0.1});
    // Another room for a while, as behind a crowd.
    const Observation seen = drive.look(n < 25 ? kOtherRoom : kRoom, 8.0, 60);
    const Pose2 expected = without.update(seen).pose.mean;
    ASSERT_EQ(with.update(seen).pose.mean, expected) << n;
    searched += with.saved_state()->size() > without.saved_state()->size() + 100 ? 1 : 0;
  }
  EXPECT_GT(searched, 60U) << "nothing was searched";
}

TEST(LocalizerWatch, TakesNoNumbersTwiceAfterAnotherPlaceTookOver) {
  const ReflectionGrid map = map_of_room();
  const Pose2Gaussian there{{9.8, 4.6, -2.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()};
  Localizer localizer = watched(map, true);  // the first start
  Pose2 pose;
  for (const Observation& observation : carried_away(60))
    pose = localizer.update(observation).pose.mean;
  ASSERT_GT(pose.x, 6.0) << "nothing took over";  // the second
  Localizer fresh = watched(map, true);
  localizer.initialize(there);
  fresh.initialize(there);
  EXPECT_NE(localizer.particles().x_m, fresh.particles().x_m);
  fresh.initialize(there);
  EXPECT_EQ(localizer.particles().x_m, fresh.particles().x_m) << "both the third";
}

TEST(LocalizerWatch, LeavesTheFilterAsItIsWhereNothingBetterIsFound) {
  const ReflectionGrid map = map_of_room();
  Localizer with = watched(map, true);
  Localizer without = watched(map, false);
  Drive drive({3.0, 2.5, 0.0}, 66);
  std::size_t doubted = 0;
  for (int n = 0; n < 150; ++n) {
    drive.step({0.03, 0.0, 0.1});
    const Observation seen = drive.look(kOtherRoom, 8.0, 60);
    const LocalizationResult a = with.update(seen);
    const LocalizationResult b = without.update(seen);
    doubted += a.score < 0.3 ? 1 : 0;
    ASSERT_EQ(a.pose.mean, b.pose.mean) << n;
    ASSERT_EQ(a.pose.covariance, b.pose.covariance) << n;
    ASSERT_EQ(a.score, b.score) << n;
  }
  EXPECT_GT(doubted, 50U) << "nothing was doubted";
  EXPECT_EQ(with.particles().x_m, without.particles().x_m);
}

TEST(LocalizerWatch, IsTheSameAtAnyNumberOfThreadsAndFromAnySavedState) {
  const ReflectionGrid map = map_of_room();
  const std::vector<Observation> seen = carried_away(40);
  Localizer one = watched(map, true);
  Localizer five = watched(map, true, 5);
  std::vector<Localizer> others;
  for (std::size_t n = 0; n < seen.size(); ++n) {
    if (n % 3 == 1) {  // before, during and after the search
      const auto state = one.saved_state();
      ASSERT_TRUE(state.has_value());
      others.push_back(watched(map, true, 2));
      others.back().restore(*state, "test");
      ASSERT_EQ(others.back().saved_state(), state) << n;
    }
    const LocalizationResult expected = one.update(seen[n]);
    ASSERT_EQ(five.update(seen[n]).pose.mean, expected.pose.mean) << n;
    for (Localizer& other : others) {
      const LocalizationResult again = other.update(seen[n]);
      ASSERT_EQ(again.pose.mean, expected.pose.mean) << n;
      ASSERT_EQ(again.is_ambiguous, expected.is_ambiguous) << n;
    }
  }
  for (Localizer& other : others) EXPECT_EQ(other.saved_state(), one.saved_state());
  EXPECT_EQ(five.particles().x_m, one.particles().x_m);
  EXPECT_EQ(five.saved_state(), one.saved_state());
}

TEST(LocalizerWatch, LooksForNothingWithoutAMapToLookIn) {
  const ReflectionGrid map = map_of_room();
  LocalizerConfig config;
  Localizer localizer(config, make_grid_beam_model(map), 4, 1);
  localizer.initialize({{3.0, 2.5, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  for (const Observation& observation : carried_away(40)) {
    EXPECT_FALSE(localizer.update(observation).is_ambiguous);
  }
}

TEST(LocalizerWatch, ForgetsItsSearchWhenSomebodySaysWhereTheRobotIs) {
  const ReflectionGrid map = map_of_room();
  const Pose2Gaussian there{{9.8, 4.6, -2.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()};
  Localizer localizer = watched(map, true);
  Localizer blind = watched(map, false);
  std::size_t searched = 0;
  for (const Observation& observation : carried_away(12)) {
    (void)localizer.update(observation);
    (void)blind.update(observation);
    searched = std::max(searched, localizer.saved_state()->size());
    if (searched > 2 * blind.saved_state()->size()) break;
  }
  ASSERT_GT(searched, 2 * blind.saved_state()->size()) << "nothing is searched";
  localizer.initialize(there);
  blind.initialize(there);
  EXPECT_EQ(localizer.saved_state()->size(), blind.saved_state()->size());
}

}  // namespace
}  // namespace strata::localization
