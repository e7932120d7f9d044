// SPDX-License-Identifier: Apache-2.0
/// A robot in a building: rides in its lift, and starts on an unknown level.
#include "core/localization/level_localizer.hpp"

#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

/// A hall of 12 m by 3 m before a cabin of 2 m by 1.7 m at its middle.
BoxWorld hall(const BoxWorld& furniture) {
  BoxWorld world = {{0.0, 1.7, 5.5, 2.0},  {6.5, 1.7, 12.0, 2.0},  {0.0, 5.0, 12.0, 5.3},
                    {-0.3, 1.7, 0.0, 5.3}, {12.0, 1.7, 12.3, 5.3}, {4.7, -0.3, 5.0, 1.7},
                    {7.0, -0.3, 7.3, 1.7}, {4.7, -0.3, 7.3, 0.0}};
  world.insert(world.end(), furniture.begin(), furniture.end());
  return world;
}
const test::Box kDoor{5.5, 1.75, 6.5, 1.95};
const test::Box kShelf{5.2, 4.3, 6.4, 5.0};  // before the lift
const test::Box kBox{9.6, 2.0, 10.6, 3.0};   // where the lift's door does not show it

/// The third looks like the first from the lift, the fourth everywhere.
std::vector<BoxWorld> worlds() {
  return {hall({kShelf}), hall({{2.0, 2.0, 3.0, 3.2}}), hall({kShelf, kBox}), hall({kShelf})};
}

LevelMaps maps_of(const BoxWorld& world) {
  const auto map =
      std::make_shared<const ReflectionGrid>(test::rasterize(world, 0.05, {{-6, -6}, {246, 106}}));
  return {make_grid_beam_model(*map), map};
}

std::unique_ptr<LevelLocalizer> localizer_of(std::vector<std::size_t> of_worlds, int threads = 1) {
  std::vector<LevelMaps> levels;
  Lift lift{{{{{5.0, 0.0}, {7.0, 0.0}, {7.0, 1.8}, {5.0, 1.8}}, {}}}, {}};
  for (std::size_t i = 0; i < of_worlds.size(); ++i) {
    levels.push_back(maps_of(worlds()[of_worlds[i]]));
    lift.levels.push_back(i);
  }
  auto localizer = std::make_unique<LevelLocalizer>(LocalizerConfig{}, LevelChoiceConfig{},
                                                    std::move(levels), 3, threads);
  localizer->set_lifts({lift});
  return localizer;
}

const Pose2 kBefore{6.0, 3.6, -0.5 * std::numbers::pi};

struct Told {
  std::size_t level = 0;
  bool is_sure = false;
  bool is_ambiguous = false;
  double error_m = 0.0;
};

/// A drive whose robot is told its level.
class Rider {
 public:
  Rider(LevelLocalizer& localizer, const Pose2& at, std::uint64_t seed)
      : localizer_(localizer), drive_(at, seed) {}
  void go(const BoxWorld& world, const Pose2& step, int steps) {
    for (int n = 0; n < steps; ++n) {
      drive_.step(step);
      Observation seen = drive_.look(world, 10.0, 120);
      seen.scan.stamp = seen.scan.stamp + Duration::from_seconds(pause_s_);
      const auto& result = localizer_.update(seen);
      told.push_back({localizer_.level(), localizer_.is_level_sure(), result.is_ambiguous,
                      translation_distance(result.pose.mean, drive_.truth())});
    }
  }
  void enter(const BoxWorld& world) { go(world, {0.1, 0.0, 0.0}, 27); }
  void leave(const BoxWorld& world) { go(world, {-0.1, 0.0, 0.0}, 25); }
  void close(BoxWorld world) {
    world.push_back(kDoor);
    go(world, {}, 30);
  }
  void pause(double s) { pause_s_ += s; }
  std::vector<Told> told;

 private:
  LevelLocalizer& localizer_;
  Drive drive_;
  double pause_s_ = 0.0;
};

TEST(LevelLocalizer, IsSureOfTheOtherLevelWithinThreeSecondsOfTheDoor) {
  const auto localizer = localizer_of({0, 1});
  localizer->initialize({kBefore, pose_covariance(0.1, 0.05)}, 0);
  EXPECT_TRUE(localizer->is_level_sure());
  Rider rider(*localizer, kBefore, 11);
  rider.enter(worlds()[0]);
  EXPECT_TRUE(localizer->is_in_lift());
  EXPECT_EQ(localizer->level(), 0U);
  rider.close(worlds()[0]);
  EXPECT_FALSE(localizer->is_level_sure()) << "nothing tells behind a closed door";
  EXPECT_FALSE(rider.told.back().is_ambiguous) << "the place is known";
  rider.told.clear();
  rider.go(worlds()[1], {}, 15);  // 3 s
  EXPECT_EQ(localizer->level(), 1U);
  EXPECT_TRUE(localizer->is_level_sure());
  rider.leave(worlds()[1]);
  EXPECT_LT(rider.told.back().error_m, 0.15);
  EXPECT_FALSE(rider.told.back().is_ambiguous);
  for (const Told& told : rider.told) EXPECT_FALSE(told.is_sure && told.level == 0);
}

TEST(LevelLocalizer, IsMisledByNoSingleScanAfterAPause) {
  const auto localizer = localizer_of({0, 1});
  localizer->initialize({kBefore, pose_covariance(0.1, 0.05)}, 0);
  Rider rider(*localizer, kBefore, 19);
  rider.enter(worlds()[0]);
  rider.pause(30.0);
  rider.go(worlds()[1], {}, 1);
  EXPECT_EQ(localizer->level(), 0U);
  rider.go(worlds()[0], {}, 3);
  EXPECT_EQ(localizer->level(), 0U);
}

TEST(LevelLocalizer, StaysOnItsLevelWhereTheDoorOpensThere) {
  const auto localizer = localizer_of({0, 1});
  localizer->initialize({kBefore, pose_covariance(0.1, 0.05)}, 0);
  Rider rider(*localizer, kBefore, 12);
  rider.enter(worlds()[0]);
  rider.close(worlds()[0]);
  rider.go(worlds()[0], {}, 15);
  EXPECT_TRUE(localizer->is_level_sure());
  rider.leave(worlds()[0]);
  for (const Told& told : rider.told) EXPECT_EQ(told.level, 0U);
  EXPECT_FALSE(rider.told.back().is_ambiguous);
}

TEST(LevelLocalizer, IsAmbiguousBetweenLevelsThatLookAlikeUntilTheyDiffer) {
  const auto localizer = localizer_of({0, 1, 2});
  localizer->initialize({kBefore, pose_covariance(0.1, 0.05)}, 1);
  Rider rider(*localizer, kBefore, 13);
  rider.enter(worlds()[1]);
  rider.close(worlds()[1]);
  rider.told.clear();
  rider.go(worlds()[2], {}, 15);
  EXPECT_FALSE(localizer->is_level_sure());
  EXPECT_NE(localizer->level(), 1U);
  rider.leave(worlds()[2]);
  rider.go(worlds()[2], {0.0, 0.0, 0.157}, 10);
  rider.go(worlds()[2], {0.1, 0.0, 0.0}, 30);
  EXPECT_TRUE(localizer->is_level_sure());
  EXPECT_EQ(localizer->level(), 2U);
  for (const Told& told : rider.told) EXPECT_FALSE(told.is_sure && told.level != 2U);
}

TEST(LevelLocalizer, IsNeverSureOfOneOfTwins) {
  for (const bool is_search : {false, true}) {
    const auto localizer = localizer_of({0, 3, 1});
    if (is_search) {
      localizer->initialize_global();
    } else {
      localizer->initialize({kBefore, pose_covariance(0.1, 0.05)}, std::nullopt);
    }
    Rider rider(*localizer, {4.0, 3.6, 0.0}, 14);
    if (!is_search)
      localizer->initialize({{4.0, 3.6, 0.0}, pose_covariance(0.1, 0.05)}, std::nullopt);
    for (int n = 0; n < 3; ++n) {
      rider.go(worlds()[3], {0.1, 0.0, 0.0}, 45);
      rider.go(worlds()[3], {0.0, 0.0, 0.157}, 20);
    }
    for (const Told& told : rider.told) EXPECT_FALSE(told.is_sure);
    EXPECT_TRUE(rider.told.back().is_ambiguous);
    EXPECT_NE(localizer->level(), 2U);
    EXPECT_EQ(localizer->beliefs().back().level, 2U);
    EXPECT_LT(localizer->beliefs().back().probability, 0.02);
  }
}

TEST(LevelLocalizer, FindsLevelAndPlaceFromNowhere) {
  const auto localizer = localizer_of({0, 1, 2});
  localizer->initialize_global();
  EXPECT_FALSE(localizer->is_level_sure());
  Rider rider(*localizer, {2.0, 3.8, 0.0}, 15);
  rider.go(worlds()[1], {0.1, 0.0, 0.0}, 70);
  EXPECT_TRUE(localizer->is_level_sure());
  EXPECT_EQ(localizer->level(), 1U);
  EXPECT_FALSE(rider.told.back().is_ambiguous);
  EXPECT_LT(rider.told.back().error_m, 0.2);
  for (const Told& told : rider.told) EXPECT_FALSE(told.is_sure && told.level != 1U);
}

TEST(LevelLocalizer, TakesTheLevelThatItIsTold) {
  const auto localizer = localizer_of({0, 3});
  localizer->initialize_global();
  Rider rider(*localizer, {4.0, 3.6, 0.0}, 16);
  rider.go(worlds()[0], {0.1, 0.0, 0.0}, 40);
  EXPECT_FALSE(localizer->is_level_sure());
  const Pose2 before = localizer->filter()->result().pose.mean;
  localizer->tell_level(1);
  EXPECT_TRUE(localizer->is_level_sure());
  EXPECT_EQ(localizer->level(), 1U);
  rider.go(worlds()[0], {}, 5);
  EXPECT_LT(translation_distance(localizer->filter()->result().pose.mean, before), 0.3);
  EXPECT_FALSE(rider.told.back().is_ambiguous);
  EXPECT_THROW(localizer->tell_level(7), InputError);
}

TEST(LevelLocalizer, GoesOnInOtherMapsOfItsLevelAndTakesFirstOnes) {
  std::vector<LevelMaps> levels{maps_of(worlds()[0]), {}};
  LevelLocalizer localizer({}, {}, std::move(levels), 3);
  EXPECT_THROW(localizer.initialize({kBefore, pose_covariance(0.1, 0.05)}, 1), InputError);
  localizer.initialize({kBefore, pose_covariance(0.1, 0.05)}, std::nullopt);
  EXPECT_TRUE(localizer.is_level_sure()) << "no other has maps";
  Rider rider(localizer, kBefore, 17);
  rider.go(worlds()[0], {0.05, 0.0, 0.0}, 5);
  localizer.set_maps(0, maps_of(worlds()[0]));
  localizer.set_maps(1, maps_of(worlds()[1]));
  rider.go(worlds()[0], {0.05, 0.0, 0.0}, 5);
  EXPECT_LT(rider.told.back().error_m, 0.15);
  localizer.tell_level(1);
  EXPECT_EQ(localizer.level(), 1U);
  EXPECT_THROW(LevelLocalizer({}, {}, {LevelMaps{}}, 1), std::invalid_argument);
}

TEST(LevelLocalizer, IsTheSameAtAnyNumberOfThreads) {
  std::vector<std::vector<double>> errors;
  for (const int threads : {1, 3}) {
    const auto localizer = localizer_of({0, 1}, threads);
    localizer->initialize({kBefore, pose_covariance(0.1, 0.05)}, 0);
    Rider rider(*localizer, kBefore, 18);
    rider.enter(worlds()[0]);
    rider.go(worlds()[1], {}, 15);
    errors.emplace_back();
    for (const Told& told : rider.told) errors.back().push_back(told.error_m);
  }
  EXPECT_EQ(errors[0], errors[1]);
}

}  // namespace
}  // namespace strata::localization
