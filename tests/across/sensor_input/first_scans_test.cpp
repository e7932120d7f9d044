// SPDX-License-Identifier: Apache-2.0
/// How long scans wait for what has not been heard yet, above all of a robot that has just started.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/runtime/sensor_input.hpp"
#include "tests/across/sensor_input/recorded_robot.hpp"

namespace strata::runtime {
namespace {

using test::at;
using test::link;
using test::odometry;
using test::scan;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(SensorInput, WhenTooManyScansWaitTheOldestGoesWithoutOdometry) {
  SensorInputConfig config;
  config.max_waiting_scans = 2;
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(odometry(0.5, {}));
  for (int i = 0; i < 3; ++i) input.add(scan(1.0 + i));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].scan.stamp, at(1.0));
  EXPECT_FALSE(taken[0].has_odometry);
  EXPECT_THAT(input.take_warnings(), IsEmpty());
}

TEST(SensorInput, OdometryThatNeverCameIsToldOnceAndWaitedForAgainWhenItComes) {
  SensorInputConfig config;
  config.max_waiting_scans = 2;
  config.first_wait_s = 0.0;
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(scan(1.0));
  input.add(scan(2.0));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(scan(3.0));
  EXPECT_THAT(input.take(), SizeIs(3));
  EXPECT_THAT(input.take_warnings(), ElementsAre(HasSubstr("no odometry comes on odom or /tf")));
  input.add(scan(4.0));
  EXPECT_THAT(input.take(), SizeIs(1));
  EXPECT_THAT(input.take_warnings(), IsEmpty());
  input.add(odometry(4.5, {1.0, 0.0, 0.0}));
  input.add(scan(5.0));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(odometry(5.0, {2.0, 0.0, 0.0}));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].odom_from_robot.x, 2.0);
}

TEST(SensorInput, AMissingMountingIsWaitedForOnceAndTakenWhenItComes) {
  SensorInputConfig config;
  config.max_waiting_scans = 2;
  config.first_wait_s = 0.0;
  SensorInput input(config, true);
  for (int i = 0; i < 50; ++i) input.add(odometry(0.1 * i, {}));
  input.add(scan(1.0));
  input.add(scan(2.0));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(scan(3.0));
  EXPECT_THAT(input.take(), SizeIs(3));
  EXPECT_THAT(
      input.take_warnings(),
      ElementsAre("tf_static does not connect laser to base_link; the laser is taken to sit "
                  "at its origin"));
  Health health;
  input.diagnose(health);
  EXPECT_EQ(health.level(), HealthLevel::kWarn);
  EXPECT_THAT(health.message(), HasSubstr("tf_static does not connect laser to base_link"));
  input.add(scan(4.0));
  EXPECT_THAT(input.take(), SizeIs(1)) << "at once";
  input.add(link(0.0, "base_link", "laser", {0.3, 0.0, 0.0}));
  input.add(scan(4.5));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].scan.robot_from_laser, (Pose2{0.3, 0.0, 0.0}));
  EXPECT_THAT(input.take_warnings(), IsEmpty());
  Health mended;
  input.diagnose(mended);
  EXPECT_EQ(mended.level(), HealthLevel::kOk) << mended.message();
}

TEST(SensorInput, OdometryThatStopsIsWaitedForNoMoreUntilItComesAgain) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(odometry(1.0, {}));
  std::size_t taken = 0;
  int waiting = 0;
  for (int i = 0; i < 100; ++i) {
    input.add(scan(1.0 + 0.1 * i));
    taken += input.take().size();
    waiting = i + 1 - static_cast<int>(taken);
    if (i == 45) {
      EXPECT_EQ(waiting, 20) << "it may come late";
    }
  }
  EXPECT_EQ(waiting, 0);
  EXPECT_THAT(input.take_warnings(), ElementsAre(HasSubstr("odometry has stopped on odom or /tf")));
  Health health;
  input.diagnose(health);
  EXPECT_THAT(health.message(), HasSubstr("no odometry comes; scans go on without it"));

  input.add(odometry(11.0, {1.0, 0.0, 0.0}));
  input.add(scan(11.1));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(odometry(11.2, {1.2, 0.0, 0.0}));
  const auto observations = input.take();
  ASSERT_THAT(observations, SizeIs(1));
  EXPECT_NEAR(observations[0].odom_from_robot.x, 1.1, 1e-9);
  Health mended;
  input.diagnose(mended);
  EXPECT_EQ(mended.level(), HealthLevel::kOk) << mended.message();
}

// A robot whose wheels' driver dies, and whose filter goes on on /tf.
TEST(SensorInput, OdometryOnTfCountsOnceTheTopicHasStopped) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(odometry(1.0, {}));
  std::vector<Observation> taken;
  for (int i = 0; i < 100; ++i) {
    const double now_s = 1.0 + 0.1 * i;
    input.add_moving(link(now_s, "odom", "base_link", {now_s, 0.0, 0.0}));
    input.add(scan(now_s));
    for (Observation& observation : input.take()) taken.push_back(std::move(observation));
  }
  ASSERT_FALSE(taken.empty());
  EXPECT_EQ(taken.back().scan.stamp, at(10.9));
  ASSERT_TRUE(taken.back().has_odometry);
  EXPECT_NEAR(taken.back().odom_from_robot.x, 10.9, 1e-9);
}

// Odometry by a clock of its own is useless, and comes all the same.
TEST(SensorInput, OdometryThatComesByAClockFarBehindHasNotStopped) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 100; ++i) {
    input.add(odometry(1.0 + 0.1 * i, {}));
    input.add(scan(1000.0 + 0.1 * i));
    (void)input.take();
  }
  EXPECT_THAT(input.take_warnings(),
              ElementsAre(HasSubstr("scans are stamped 999.00 s after the newest odometry")));
}

TEST(SensorInput, AScannerThatComesBackUnderAnotherFrameIsNotSilent) {
  SensorInput input({}, true);
  const auto is_silent = [&] {
    Health health;
    input.diagnose(health);
    return health.message().find("is silent") != std::string::npos;
  };
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(link(0.0, "base_link", "laser_2", {}));
  const auto drive = [&](double from_s, double to_s, const std::string& frame) {
    for (double now_s = from_s; now_s < to_s; now_s += 0.1) {
      input.add(odometry(now_s, {}));
      input.add(scan(now_s, frame));
      (void)input.take();
    }
  };
  drive(1.0, 2.0, "laser");
  drive(3.0, 6.0, "laser_2");
  EXPECT_FALSE(is_silent());
  // Of two that spoke together the one that falls silent is missed.
  for (double now_s = 6.0; now_s < 7.0; now_s += 0.1) {
    drive(now_s, now_s + 0.01, "laser");
    drive(now_s + 0.02, now_s + 0.03, "laser_2");
  }
  drive(7.0, 9.0, "laser_2");
  EXPECT_TRUE(is_silent());
}

// Each goes by a clock of its own: neither was set back.
TEST(SensorInput, TwoScannersWhoseClocksDifferSetNoClockBack) {
  SensorInputConfig config;
  config.use_odometry = false;
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(link(0.0, "base_link", "laser_2", {}));
  for (int i = 0; i < 50; ++i) {
    for (const double ahead_s : {0.0, 2.0}) {
      input.add(scan(1.0 + 0.1 * i + ahead_s, ahead_s == 0.0 ? "laser" : "laser_2"));
      (void)input.take();
      EXPECT_FALSE(input.take_set_back()) << i;
    }
  }
}

TEST(SensorInput, AClockThatIsSetBackIsToldWithTheScansByTheOldOne) {
  SensorInputConfig config;
  config.max_waiting_scans = 100;
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(odometry(1000.0, {}));
  for (int i = 1; i <= 3; ++i) input.add(scan(1000.0 + 0.1 * i));  // they wait for odometry
  EXPECT_THAT(input.take(), IsEmpty());
  EXPECT_FALSE(input.take_set_back());
  input.add(scan(500.0));
  EXPECT_FALSE(input.take_set_back()) << "it may have come late";
  input.add(scan(500.1));
  EXPECT_THAT(input.take(), SizeIs(3));
  EXPECT_EQ(input.take_set_back(), 3U);
  EXPECT_FALSE(input.take_set_back());
}

// At a start the reader of odometry may meet its writer later than the scans' reader theirs.
TEST(FirstScans, OfAFastScannerInABurstWaitForTheirOdometry) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 40; ++i) {
    input.add(scan(1.0 + 0.025 * i));
    EXPECT_THAT(input.take(), IsEmpty()) << i;
  }
  for (int i = 0; i <= 30; ++i) input.add(odometry(0.9 + 0.05 * i, {0.9 + 0.05 * i, 0.0, 0.0}));
  const auto taken = input.take();
  ASSERT_THAT(taken, SizeIs(40));
  for (const Observation& observation : taken) {
    EXPECT_TRUE(observation.has_odometry);
    EXPECT_NEAR(observation.odom_from_robot.x, observation.scan.stamp.seconds(), 1e-9);
  }
  EXPECT_THAT(input.take_warnings(), IsEmpty());
}

TEST(FirstScans, OfAFastScannerInABurstWaitForItsMounting) {
  SensorInput input({}, true);
  for (int i = 0; i <= 40; ++i) input.add(odometry(0.9 + 0.05 * i, {}));
  for (int i = 0; i < 40; ++i) input.add(scan(1.0 + 0.025 * i));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(link(0.0, "base_link", "laser", {0.3, 0.0, 0.0}));
  const auto taken = input.take();
  ASSERT_THAT(taken, SizeIs(40));
  EXPECT_EQ(taken.front().scan.robot_from_laser, (Pose2{0.3, 0.0, 0.0}));
}

TEST(FirstScans, WaitForWhatNobodyPublishesSoManySecondsOfStampsAndSoManyScans) {
  SensorInputConfig config;
  config.first_wait_s = 3.0;
  for (const double period_s : {0.1, 0.025}) {
    SensorInput input(config, true);
    input.add(link(0.0, "base_link", "laser", {}));
    int waiting = 0;
    for (; input.take().empty(); ++waiting) input.add(scan(1.0 + period_s * waiting));
    EXPECT_EQ(waiting, static_cast<int>(std::lround(3.0 / period_s)) + 1);
    EXPECT_THAT(input.take_warnings(), ElementsAre(HasSubstr("no odometry comes")));
  }
  SensorInput slow(config, true);
  slow.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 20; ++i) slow.add(scan(1.0 + i));
  EXPECT_THAT(slow.take(), IsEmpty());
  slow.add(scan(21.0));
  EXPECT_THAT(slow.take(), SizeIs(21));
}

TEST(FirstScans, WhoseStampsStandStillDoNotFillTheMemory) {
  SensorInput input({}, true);
  for (int i = 0; i < 200; ++i) input.add(scan(1.0));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(scan(1.0));
  EXPECT_THAT(input.take(), SizeIs(201));
}

}  // namespace
}  // namespace strata::runtime
