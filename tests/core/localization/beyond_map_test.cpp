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

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"
#include "tests/core/localization/unmapped_room.hpp"

namespace strata::localization {
namespace {

using test::Drive;

using unmapped_room::building;
using unmapped_room::corridor_map;
using unmapped_room::models;

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
    beyond.settle();
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

TEST(BeyondMap, ARobotThatIsOutsideStaysSoHoweverFarItsParticlesSpread) {
  const auto model = models().front();
  Drive drive({8.5, 5.0, 0.0}, 4);
  BeyondMap beyond{BeyondMapConfig{}};
  constexpr double kWide_m = 5.0;
  const Scan first = drive.look(building()).scan;
  EXPECT_EQ(beyond.judged(first, *model, drive.truth(), kWide_m), &first) << "not known to be";
  const Scan* weighed = nullptr;
  for (int n = 0; n < 5; ++n) {
    const Observation seen = drive.look(building());
    (void)beyond.follow(seen);
    weighed = beyond.judged(seen.scan, *model, drive.truth(), n < 4 ? 0.1 : kWide_m);
    EXPECT_EQ(beyond.is_outside(), true);
    if (n < 4) beyond.settle();
  }
  EXPECT_EQ(weighed, nullptr);
}

TEST(BeyondMap, TheVerdictIsOfTheBeamsThatAreJudged) {
  Localizer localizer(config(true), models().front(), 5);
  Drive drive({8.5, 1.4, 0.0}, 4);
  localizer.initialize({drive.truth(), Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
  LocalizationResult result;
  for (int n = 0; n < 40; ++n) {
    drive.step({0.001, 0.0, 0.0});
    result = localizer.update(drive.look(building()));
  }
  EXPECT_FALSE(result.is_beyond_map) << "most of the scan is in the corridor";
  EXPECT_LT(result.health.judged_share_fast, 0.85) << "the gap";
  EXPECT_GT(result.health.inlier_share_fast, 0.9);
  EXPECT_EQ(result.health.state, HealthState::kGood);
}

TEST(BeyondMap, WeighsLessWhereTheMapIsOutdatedBesidesAndScansTellTheMotion) {
  const auto model = models().front();
  Drive drive({8.5, 5.0, 0.0}, 4);
  BeyondMapConfig config;
  config.outdated_tempering = 5.0;
  BeyondMap beyond{config};
  EXPECT_EQ(beyond.tempering(true), 1.0);
  for (int n = 0; n < 3; ++n) {
    beyond.settle();
    const Observation seen = drive.look(building());
    (void)beyond.follow(seen);
    (void)beyond.judged(seen.scan, *model, drive.truth(), 0.1);
  }
  EXPECT_EQ(beyond.tempering(true), 5.0);
  EXPECT_EQ(beyond.tempering(false), 1.0);
  beyond.settle();
  EXPECT_EQ(beyond.tempering(true), 1.0) << "nothing is told yet of the next motion";
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
