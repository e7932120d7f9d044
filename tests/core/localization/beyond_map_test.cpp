// SPDX-License-Identifier: Apache-2.0
// A robot that drives where nobody has mapped, and comes back.
#include "core/localization/beyond_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/rays/ray_caster.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

/// A corridor of 16 m x 2 m with pillars, and beside it a room that is entered by a gap at x = 8 to
/// 9 m; the wall between them is 0.3 m thick.
BoxWorld building() {
  return {{0.0, -0.3, 16.0, 0.0},
          {-0.3, -0.3, 0.0, 2.3},
          {16.0, -0.3, 16.3, 2.3},
          {0.0, 2.0, 8.0, 2.3},
          {9.0, 2.0, 16.0, 2.3},
          {3.0, 0.0, 3.4, 0.5},
          {5.6, 1.6, 6.0, 2.0},
          {11.0, 0.0, 11.3, 0.6},
          {13.0, 1.5, 13.5, 2.0},
          // The room.
          {4.7, 2.0, 5.0, 8.0},
          {12.0, 2.0, 12.3, 8.0},
          {4.7, 8.0, 12.3, 8.3},
          {6.0, 5.0, 6.8, 6.0},
          {10.0, 4.0, 10.5, 5.5}};
}

constexpr double kInnerWall_m = 2.05;

/// What was seen from the corridor only: it, and the first cell of every wall.
ReflectionGrid corridor_map() {
  ReflectionGrid map = test::rasterize(building(), 0.05, {{-6, -6}, {326, 166}});
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Eigen::Vector2d at = map.center(map.cell(i));
    const bool is_seen =
        at.x() > -0.05 && at.x() < 16.05 && at.y() > -0.05 && at.y() < kInnerWall_m;
    if (!is_seen) map.values()[i] = kUnknownReflection;
  }
  return map;
}

std::shared_ptr<const patch::PatchMap> as_patch_map() {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = corridor_map();
  return map;
}

std::vector<std::shared_ptr<const SensorModel>> models() {
  return {make_grid_beam_model(corridor_map()),
          std::make_shared<const patch_beams::PatchBeamModel>(as_patch_map()),
          std::make_shared<const LikelihoodFieldModel>(corridor_map())};
}

/// One beam of that range, straight ahead.
Scan beam(double range_m) {
  Scan scan;
  scan.angle_increment_rad = 0.1F;
  scan.range_min_m = 0.05F;
  scan.range_max_m = 30.0F;
  scan.ranges_m = {static_cast<float>(range_m)};
  return scan;
}

bool is_unjudged(const SensorModel& model, const Pose2& from, double range_m) {
  std::vector<std::uint8_t> marks;
  model.find_unjudged(beam(range_m), from, marks);
  return marks.at(0) != 0;
}

TEST(UnjudgedBeams, AreThoseThatGoWhereNobodyHasBeen) {
  constexpr double kUp = std::numbers::pi / 2.0;
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  for (const auto& model : models()) {
    EXPECT_FALSE(is_unjudged(*model, {2.0, 1.0, kUp}, 1.0)) << "the wall";
    EXPECT_FALSE(is_unjudged(*model, {2.0, 1.0, kUp}, 0.4)) << "something new before it";
    EXPECT_FALSE(is_unjudged(*model, {2.0, 1.0, kUp}, 3.0)) << "through the wall";
    EXPECT_TRUE(is_unjudged(*model, {8.5, 1.0, kUp}, 4.0)) << "through the gap into the room";
    EXPECT_FALSE(is_unjudged(*model, {8.5, 0.5, kUp}, 0.8)) << "a person before the gap";
    EXPECT_TRUE(is_unjudged(*model, {7.0, 4.0, -kUp}, 1.7)) << "the wall from its other side";
    EXPECT_FALSE(is_unjudged(*model, {7.0, 4.0, -kUp}, 3.8)) << "through it from there";
    EXPECT_TRUE(is_unjudged(*model, {8.5, 4.0, -kUp}, 4.0)) << "from the room through the gap";
    EXPECT_TRUE(is_unjudged(*model, {7.0, 4.0, kUp}, kNothing)) << "nothing, from the room";
    EXPECT_FALSE(is_unjudged(*model, {8.5, 1.0, kUp}, kNothing)) << "nothing, through the gap";
  }
}

TEST(UnjudgedBeams, OfReadingsThatSayNothingAreNone) {
  const Pose2 in_the_room{7.0, 4.0, 0.0};
  for (const float reading : {std::numeric_limits<float>::quiet_NaN(), 0.0F, -1.0F}) {
    for (const auto& model : models()) {
      EXPECT_FALSE(is_unjudged(*model, in_the_room, static_cast<double>(reading)));
    }
  }
}

/// Everything is known but x in [begin, end).
struct Gap {
  double begin_m, end_m;
  [[nodiscard]] bool knows(const Eigen::Vector2d& point_m) const {
    return point_m.x() < begin_m || point_m.x() >= end_m;
  }
};

TEST(UnknownWay, IsWhatOfTheWayIsUnknown) {
  const Eigen::Vector2d ahead(1.0, 0.0);
  for (const double end_m : {1.0, 1.5, 3.2}) {
    EXPECT_NEAR(unknown_way_m(Gap{1.0, end_m}, {0.0, 0.0}, ahead, 5.0), end_m - 1.0, 0.051);
    EXPECT_EQ(unknown_way_m(Gap{1.0, end_m}, {0.0, 0.0}, ahead, 0.9), 0.0);
    EXPECT_EQ(unknown_way_m(Gap{1.0, end_m}, {0.0, 0.0}, -ahead, 5.0), 0.0);
  }
  EXPECT_EQ(unknown_way_m(Gap{0.0, 9.0}, {1.0, 0.0}, ahead, -1.0), 0.0);
}

struct Outcome {
  double max_error_m = 0.0;   // in the room
  double back_error_m = 0.0;  // in the corridor again, the last scans
  double max_stddev_m = 0.0;
  int beyond_scans = 0;
  int good_scans = 0;  // called so after a while there
  bool is_beyond_at_the_end = true;
};

/// Along the corridor, through the gap, twice round in the room and back, with an odometry whose
/// turns are counted 8% too large: metres off after the room.
class Trip {
 public:
  explicit Trip(std::uint64_t seed) : drive_({1.5, 1.0, 0.0}, seed) {}

  Outcome run(Localizer& localizer) {
    localizer.initialize({drive_.truth(), Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
    straight(localizer, 7.0);
    turn(localizer, std::numbers::pi / 2.0);
    straight(localizer, 2.3);
    is_in_room_ = true;
    straight(localizer, 2.5);
    for (int side = 0; side < 6; ++side) {
      turn(localizer, std::numbers::pi / 2.0);
      straight(localizer, 1.0);
    }
    turn(localizer, std::numbers::pi / 2.0);
    straight(localizer, 1.0);
    turn(localizer, -std::numbers::pi / 2.0);
    is_in_room_ = false;
    const Pose2 to_gap = between(drive_.truth(), {8.5, 1.0, 0.0});
    turn(localizer, std::atan2(to_gap.y, to_gap.x));
    straight(localizer, std::hypot(to_gap.x, to_gap.y));
    turn(localizer, between(drive_.truth(), {0.0, 0.0, std::numbers::pi}).theta);
    straight(localizer, 5.0);
    return outcome_;
  }

 private:
  void go(Localizer& localizer, const Pose2& motion) {
    drive_.step(motion);
    Observation seen = drive_.look(building());
    odom_ = odom_ * Pose2{motion.x, motion.y, 1.08 * motion.theta};
    seen.odom_from_robot = odom_;
    const LocalizationResult& found = localizer.update(seen);
    const double error_m = translation_distance(found.pose.mean, drive_.truth());
    if (is_in_room_) outcome_.max_error_m = std::max(outcome_.max_error_m, error_m);
    outcome_.back_error_m = error_m;
    outcome_.beyond_scans += found.is_beyond_map ? 1 : 0;
    const bool is_long_there = found.is_beyond_map && outcome_.beyond_scans > 30;
    outcome_.good_scans += is_long_there && found.health.state == HealthState::kGood ? 1 : 0;
    outcome_.is_beyond_at_the_end = found.is_beyond_map;
    outcome_.max_stddev_m = std::max(outcome_.max_stddev_m, std::sqrt(found.pose.covariance(0, 0) +
                                                                      found.pose.covariance(1, 1)));
  }
  void straight(Localizer& localizer, double way_m) {
    const int steps = std::max(1, static_cast<int>(way_m / 0.1));
    for (int n = 0; n < steps; ++n) go(localizer, {way_m / steps, 0.0, 0.0});
  }
  void turn(Localizer& localizer, double angle_rad) {
    const int steps = std::max(1, static_cast<int>(std::abs(angle_rad) / 0.1));
    for (int n = 0; n < steps; ++n) go(localizer, {0.0, 0.0, angle_rad / steps});
  }

  Drive drive_;
  Pose2 odom_;
  bool is_in_room_ = false;
  Outcome outcome_;
};

LocalizerConfig config(bool is_used) {
  LocalizerConfig config;
  config.beyond_map.is_used = is_used;
  return config;
}

TEST(BeyondMap, ARoomThatNobodyMappedDoesNotLoseTheRobot) {
  for (const auto& model : models()) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Localizer localizer(config(true), model, seed);
      const Outcome outcome = Trip(seed).run(localizer);
      EXPECT_LT(outcome.max_error_m, 0.1) << "seed " << seed;
      EXPECT_LT(outcome.back_error_m, 0.1) << "seed " << seed;
      EXPECT_GT(outcome.beyond_scans, 60) << "seed " << seed;
      EXPECT_EQ(outcome.good_scans, 0) << "seed " << seed;
      EXPECT_FALSE(outcome.is_beyond_at_the_end) << "seed " << seed;
      EXPECT_GT(outcome.max_stddev_m, 0.05) << "it is less sure there; seed " << seed;
      EXPECT_LT(localizer.saved_state()->size(), std::size_t{200'000})
          << "the last metres are kept beyond the map only; seed " << seed;
    }
  }
}

TEST(BeyondMap, WithoutItTheFarSidesOfWallsPullThePose) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Localizer localizer(config(false), models().front(), seed);
    const Outcome outcome = Trip(seed).run(localizer);
    EXPECT_EQ(outcome.beyond_scans, 0);
    EXPECT_GT(outcome.max_error_m, 0.2) << "seed " << seed;
  }
}

TEST(BeyondMap, ARobotInItsMapIsWeighedAsEver) {
  const auto model =
      make_grid_beam_model(test::rasterize(building(), 0.05, {{-6, -6}, {326, 166}}));
  Localizer with(config(true), model, 3);
  Localizer without(config(false), model, 3);
  const Outcome a = Trip(7).run(with);
  const Outcome b = Trip(7).run(without);
  EXPECT_EQ(a.beyond_scans, 0);
  EXPECT_EQ(a.max_error_m, b.max_error_m);
  EXPECT_EQ(a.back_error_m, b.back_error_m);
}

/// What scans tell of the motion after `count` that the map judges whole, behind one that it does
/// not; and whether they do again with the next that it does not.
std::pair<bool, bool> are_told_after(int count) {
  const auto model = models().front();
  BeyondMap beyond{BeyondMapConfig{}};
  Drive drive({2.0, 1.0, 0.0}, 4);
  const Pose2 in_the_room{8.5, 5.0, 0.0};  // from there it would be beyond the map
  const auto see_from = [&](const Pose2& pose) {
    const Observation seen = drive.look(building());
    const bool is_told = beyond.follow(seen).has_value();
    (void)beyond.judged(seen.scan, *model, pose, 0.01);
    beyond.settle(0.0);
    return is_told;
  };
  (void)see_from(in_the_room);
  EXPECT_TRUE(beyond.is_beyond());
  for (int n = 0; n < count; ++n) {
    (void)see_from(drive.truth());
    EXPECT_FALSE(beyond.is_beyond());
  }
  const bool is_told = see_from(in_the_room);
  return {is_told, see_from(in_the_room)};
}

TEST(BeyondMap, ScansTellTheMotionWhereTheMapDoesNotAndAreReadyForAWhileAfter) {
  EXPECT_EQ(are_told_after(0), (std::pair{false, true})) << "of the first scan nothing is known";
  EXPECT_EQ(are_told_after(10), (std::pair{false, true})) << "the map says more";
  EXPECT_EQ(are_told_after(25), (std::pair{false, false})) << "it begins anew";
}

TEST(BeyondMap, KnowsHowFarTheRobotDroveWithNoScanWeighedUntilItWasLookedFor) {
  const auto model = models().front();
  BeyondMapConfig config;
  config.search_after_m = 2.0;
  BeyondMap beyond{config};
  Drive drive({2.0, 1.0, 0.0}, 4);
  const Scan scan = drive.look(building()).scan;
  const auto see_from = [&](const Pose2& pose, double moved_m) {
    (void)beyond.judged(scan, *model, pose, 0.01);
    beyond.settle(moved_m);
  };
  const Pose2 in_the_room{8.5, 5.0, 0.0};
  see_from(in_the_room, 1.0);
  see_from(drive.truth(), 5.0);
  EXPECT_EQ(beyond.came_back_m(), 0.0) << "too short a way";
  see_from(in_the_room, 1.5);
  EXPECT_EQ(beyond.came_back_m(), 0.0) << "still there";
  see_from(drive.truth(), 5.0);
  EXPECT_EQ(beyond.came_back_m(), 2.5);
  EXPECT_EQ(beyond.drift_m(2.5), 0.5);
  EXPECT_EQ(beyond.drift_m(20.0), 2.0);
  beyond.looked_for();
  EXPECT_EQ(beyond.came_back_m(), 0.0);
}

/// Saved after scan `cut` of a drive into the room.
void expect_same_after(int cut) {
  const auto model = models().front();
  Localizer first(config(true), model, 5);
  Localizer second(config(true), model, 5);
  Drive drive({8.5, 1.0, std::numbers::pi / 2.0}, 4);
  first.initialize({drive.truth(), Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
  for (int n = 0; n < 60; ++n) {
    drive.step({0.06, 0.0, 0.0});
    const Observation seen = drive.look(building());
    const LocalizationResult expected = first.update(seen);
    if (n == cut) {
      ASSERT_TRUE(expected.is_beyond_map);
      const auto state = first.saved_state();
      ASSERT_TRUE(state);
      second.restore(*state, "state");
    } else if (n > cut) {
      const Pose2 found = second.update(seen).pose.mean;
      ASSERT_EQ(found.x, expected.pose.mean.x) << n;
      ASSERT_EQ(found.theta, expected.pose.mean.theta) << n;
    }
  }
  EXPECT_TRUE(first.saved_state() == second.saved_state());
}

TEST(BeyondMap, GoesOnFromASavedStateToTheBit) {
  // One of two scans is weighed.
  for (const int cut : {35, 36}) expect_same_after(cut);
}

TEST(BeyondMap, NothingIsLeftOutWhileTheRobotMayBeAnywhere) {
  Localizer localizer(config(true), models().front(), 5);
  Drive drive({8.5, 5.0, 0.0}, 4);
  localizer.initialize({drive.truth(), Eigen::Vector3d(4.0, 4.0, 0.1).asDiagonal()});
  EXPECT_FALSE(localizer.update(drive.look(building())).is_beyond_map);
  localizer.initialize({drive.truth(), Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
  EXPECT_TRUE(localizer.update(drive.look(building())).is_beyond_map);
}

TEST(BeyondMap, IsForgottenWhileTheRobotIsSoughtInTheWholeMap) {
  Localizer localizer(config(true), models().front(), 5);
  localizer.set_free_space(corridor_map());
  Drive drive({8.5, 5.0, 0.0}, 4);
  localizer.initialize({drive.truth(), Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
  ASSERT_TRUE(localizer.update(drive.look(building())).is_beyond_map);
  localizer.initialize_global();
  EXPECT_FALSE(localizer.update(drive.look(building())).is_beyond_map);
}

}  // namespace
}  // namespace strata::localization
