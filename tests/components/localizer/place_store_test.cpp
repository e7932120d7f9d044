// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/place_store.hpp"

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::localizer {
namespace {

constexpr double kExact = 1e-12;

Observation observation_at(double time_s, const Pose2& odom_from_robot) {
  Observation observation;
  observation.scan.stamp = Stamp::from_seconds(time_s);
  observation.odom_from_robot = odom_from_robot;
  return observation;
}

class PlaceStoreTest : public ::testing::Test {
 protected:
  [[nodiscard]] PlaceStore store(double period_s = 0.0) const {
    PlaceStoreConfig config;
    config.file = file_.string();
    config.period_s = period_s;
    return {config, 0.5 * Eigen::Matrix3d::Identity()};
  }
  /// What a process after this one begins with.
  [[nodiscard]] std::optional<PlaceStore::Resumed> resumed_in(const ReflectionGrid& map,
                                                              const Observation& first) const {
    PlaceStore next = store();
    next.load();
    return next.resume(first, map);
  }
  /// ... where there is no map to ask.
  [[nodiscard]] std::optional<Pose2Gaussian> resumed(const Observation& first) const {
    const auto resumed = resumed_in({}, first);
    return resumed ? std::optional(resumed->map_from_robot) : std::nullopt;
  }
  static inline const Pose2 kPlace{1.25, -2.5, 0.75};

  test::TemporaryDirectory folder_;
  std::filesystem::path file_ = folder_.path() / "place.yaml";
};

TEST_F(PlaceStoreTest, GivesBackWhatWasKeptWithTheAddedUncertainty) {
  Pose2Gaussian place{kPlace, Eigen::Matrix3d::Identity()};
  place.covariance(0, 1) = place.covariance(1, 0) = 0.25;
  store().keep(observation_at(100.0, {}), place);
  const auto back = resumed(observation_at(100.5, {}));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->mean, kPlace);
  const Eigen::Matrix3d expected = place.covariance + 0.5 * Eigen::Matrix3d::Identity();
  EXPECT_EQ(back->covariance, expected);
}

TEST_F(PlaceStoreTest, IsDeadReckonedByOdometryThatWentOnAndByNoOther) {
  const Pose2 odom{10.0, 20.0, 1.0};
  const Pose2 moved{0.5, 0.1, 0.2};
  store().keep(observation_at(100.0, odom), {kPlace, Eigen::Matrix3d::Identity()});
  const auto soon = resumed(observation_at(109.0, odom * moved));
  ASSERT_TRUE(soon.has_value());
  const Pose2 expected = kPlace * moved;
  EXPECT_NEAR(soon->mean.x, expected.x, kExact);
  EXPECT_NEAR(soon->mean.y, expected.y, kExact);
  EXPECT_NEAR(soon->mean.theta, expected.theta, kExact);
  // After a reboot odometry begins anew; a clock that was set back tells nothing.
  for (const double time_s : {111.0, 99.0}) {
    EXPECT_EQ(resumed(observation_at(time_s, moved))->mean, kPlace) << time_s;
  }
  Observation blind = observation_at(101.0, {});
  blind.has_odometry = false;
  EXPECT_EQ(resumed(blind)->mean, kPlace);
}

// A robot that moves would else be put where it was, for scans are often heard before odometry.
TEST_F(PlaceStoreTest, WaitsForOdometryThatWentOn) {
  store().keep(observation_at(100.0, {}), {kPlace, Eigen::Matrix3d::Identity()});
  PlaceStore next = store();
  EXPECT_FALSE(next.waits_for_odometry(observation_at(101.0, {}), true)) << "nothing is kept";
  next.load();
  Observation blind = observation_at(101.0, {});
  blind.has_odometry = false;
  EXPECT_TRUE(next.waits_for_odometry(blind, true));
  EXPECT_FALSE(next.waits_for_odometry(blind, false)) << "none will come";
  EXPECT_FALSE(next.waits_for_odometry(observation_at(101.0, {}), true));
  blind.scan.stamp = Stamp::from_seconds(111.0);
  EXPECT_FALSE(next.waits_for_odometry(blind, true)) << "it may have begun anew";
}

TEST_F(PlaceStoreTest, ResumesOnceAndNotWhenSomethingNewerIsKnown) {
  store().keep(observation_at(100.0, {}), {kPlace, Eigen::Matrix3d::Identity()});
  PlaceStore next = store();
  next.load();
  EXPECT_TRUE(next.resume(observation_at(101.0, {}), {}).has_value());
  EXPECT_FALSE(next.resume(observation_at(102.0, {}), {}).has_value());
  PlaceStore told = store();
  told.load();
  told.forget();
  EXPECT_FALSE(told.resume(observation_at(101.0, {}), {}).has_value());
}

/// A corridor with a room, its map, and what a robot sees in it.
class PlaceInAMap : public PlaceStoreTest {
 protected:
  PlaceInAMap() {
    RandomStream random(1, StreamId::kTest);
    std::vector<PosedScan> scans;
    robot_.drive(world_, {1.0, 1.2, 0.0}, {10.0, 1.2, 0.0}, 0, 0.0, {}, random, scans);
    robot_.drive(world_, {5.5, 1.2, 1.57}, {5.5, 4.5, 1.57}, 0, 50.0, {}, random, scans);
    map_ = patch::test_world::map_of(scans);
    store().keep(observation_at(100.0, kOdometry), {kWas, Eigen::Matrix3d::Identity() * 0.01});
  }
  [[nodiscard]] Observation seen_from(const Pose2& truth, double time_s, const Pose2& odometry) {
    Observation observation = observation_at(time_s, odometry);
    observation.scan = robot_.scan_at(world_, truth, random_).scan;
    observation.scan.stamp = Stamp::from_seconds(time_s);
    return observation;
  }
  static inline const Pose2 kOdometry{10.0, 20.0, 1.0};
  static inline const Pose2 kWas{3.0, 1.2, 0.2};
  static inline const Pose2 kMoved{1.5, 0.1, 0.3};

  const patch::test_world::ToyWorld world_ = patch::test_world::corridor_with_door(false);
  const patch::test_world::ToyRobot robot_;
  RandomStream random_{2, StreamId::kTest};
  ReflectionGrid map_;
};

// The driver is often started again together with the localizer.
TEST_F(PlaceInAMap, OdometryThatBeganAnewAMomentAgoIsFoundOut) {
  const auto resumed = resumed_in(map_, seen_from(kWas, 103.0, {}));
  ASSERT_TRUE(resumed.has_value());
  EXPECT_TRUE(resumed->fits);
  EXPECT_LT(translation_distance(resumed->map_from_robot.mean, kWas), 0.2);
}

TEST_F(PlaceInAMap, OdometryThatWentOnIsBelieved) {
  const auto resumed = resumed_in(map_, seen_from(kWas * kMoved, 103.0, kOdometry * kMoved));
  ASSERT_TRUE(resumed.has_value());
  EXPECT_TRUE(resumed->fits);
  EXPECT_LT(translation_distance(resumed->map_from_robot.mean, kWas * kMoved), 1e-9);
}

TEST_F(PlaceInAMap, OdometryThatWentOnForAnHourIsBelievedWhereTheScanSaysSo) {
  const auto resumed = resumed_in(map_, seen_from(kWas * kMoved, 3700.0, kOdometry * kMoved));
  ASSERT_TRUE(resumed.has_value());
  EXPECT_LT(translation_distance(resumed->map_from_robot.mean, kWas * kMoved), 0.2);
  const auto stood = resumed_in(map_, seen_from(kWas, 3700.0, kOdometry * kMoved));
  EXPECT_LT(translation_distance(stood->map_from_robot.mean, kWas), 1e-9);
}

TEST_F(PlaceInAMap, AMapThatComesLateIsAskedAsIfItHadComeAtOnce) {
  PlaceStore next = store();
  next.load();
  next.hear(seen_from(kWas, 103.0, kOdometry));
  const Observation now = seen_from(kWas * kMoved, 140.0, kOdometry * kMoved);
  const auto resumed = next.resume(now, map_);
  ASSERT_TRUE(resumed.has_value());
  EXPECT_LT(translation_distance(resumed->map_from_robot.mean, kWas * kMoved), 1e-9);
}

TEST_F(PlaceInAMap, ARobotThatWasCarriedIsFoundOut) {
  const auto resumed = resumed_in(map_, seen_from({6.5, 4.5, 2.0}, 103.0, kOdometry));
  ASSERT_TRUE(resumed.has_value());
  EXPECT_FALSE(resumed->fits);
}

TEST_F(PlaceStoreTest, WritesOnceAPeriodAlsoWhenTheClockIsSetBack) {
  PlaceStore kept = store(1.0);
  const auto keep = [&](double time_s, double x) {
    kept.keep(observation_at(time_s, {}), {Pose2{x, 0.0, 0.0}, Eigen::Matrix3d::Identity()});
    kept.flush();
    return resumed(observation_at(1e6, {}))->mean.x;
  };
  EXPECT_EQ(keep(100.0, 1.0), 1.0);
  EXPECT_EQ(keep(100.9, 2.0), 1.0);
  EXPECT_EQ(keep(101.0, 3.0), 3.0);
  EXPECT_EQ(keep(50.0, 4.0), 4.0);
}

TEST_F(PlaceStoreTest, StartsWithNothingWithoutAFileAndRefusesADamagedOne) {
  EXPECT_FALSE(resumed(observation_at(1.0, {})).has_value());
  for (const std::string text :
       {"", "version: 1\n", "version: 1\nmap_from_robot: [.nan, 0, 0]\n", "version: [", "\x01"}) {
    std::ofstream(file_, std::ios::trunc) << text;
    PlaceStore next = store();
    EXPECT_THROW(next.load(), InputError) << text;
    EXPECT_FALSE(next.resume(observation_at(1.0, {}), {}).has_value());
  }
}

}  // namespace
}  // namespace strata::localizer
