// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sensor_input.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"
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

const double kPi = std::acos(-1.0);

void expect_near(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(std::remainder(a.theta - b.theta, 2.0 * kPi), 0.0, 1e-12);
}

TEST(SensorInput, AScanWaitsForItsMountingAndForOdometryPastIt) {
  SensorInput input({}, true);
  input.add(scan(1.0));
  EXPECT_TRUE(input.take().empty());
  input.add(odometry(0.5, {0.0, 0.0, 0.0}));
  input.add(odometry(1.5, {2.0, 0.0, 0.0}));
  EXPECT_TRUE(input.take().empty()) << "nobody knows where the laser sits";
  input.add(link(0.0, "base_link", "laser", {0.3, 0.0, 0.0}));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_TRUE(taken[0].has_odometry);
  expect_near(taken[0].odom_from_robot, {1.0, 0.0, 0.0});
  expect_near(taken[0].scan.robot_from_laser, {0.3, 0.0, 0.0});
}

TEST(SensorInput, MountingsComposeAlongTheTreeAlsoUpsideDown) {
  SensorInput input({}, false);
  input.add(link(0.0, "/base_link", "/mast", {1.0, 0.0, kPi / 2.0}));
  // Rolled over about x: what turned left turns right.
  tf2_msgs::msg::TFMessage rolled = link(0.0, "mast", "plate", {});
  rolled.transforms()[0].transform().rotation().w(0.0);
  rolled.transforms()[0].transform().rotation().x(1.0);
  input.add(rolled);
  input.add(link(0.0, "plate", "laser", {1.0, 1.0, kPi / 4.0}));
  input.add(scan(1.0));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  // By hand: (1, 1) rolled is (1, -1), turned left (1, 1), and a left turn of 45 is one to the
  // right below the roll.
  expect_near(taken[0].scan.robot_from_laser, {2.0, 1.0, kPi / 4.0});
}

TEST(SensorInput, TakesOdometryFromTfAloneAndThroughTheFootprint) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_footprint", "base_link", {0.0, 0.5, 0.0}));
  input.add(link(0.0, "base_link", "laser", {}));
  input.add_moving(link(0.9, "map", "odom", {100.0, 0.0, 0.0}));  // ours or another's
  input.add_moving(link(1.0, "odom", "base_footprint", {1.0, 0.0, 0.0}));
  input.add(scan(1.25));
  EXPECT_TRUE(input.take().empty());
  input.add_moving(link(1.5, "odom", "base_footprint", {2.0, 0.0, 0.0}));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_TRUE(taken[0].has_odometry);
  expect_near(taken[0].odom_from_robot, {1.5, 0.5, 0.0});
}

TEST(SensorInput, TheOdometryTopicWinsOverTf) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add_moving(link(1.0, "odom", "base_link", {50.0, 0.0, 0.0}));
  input.add(odometry(1.0, {1.0, 0.0, 0.0}));
  input.add_moving(link(2.0, "odom", "base_link", {60.0, 0.0, 0.0}));
  input.add(odometry(2.0, {2.0, 0.0, 0.0}));
  input.add(scan(1.5));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  expect_near(taken[0].odom_from_robot, {1.5, 0.0, 0.0});
}

TEST(SensorInput, TfIsLeftAloneWhenItIsNotWanted) {
  SensorInputConfig config;
  config.tf_odometry_frame.clear();
  SensorInput input(config, false);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add_moving(link(1.0, "odom", "base_link", {1.0, 0.0, 0.0}));
  input.add(scan(1.0));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_FALSE(taken[0].has_odometry);
}

TEST(SensorInput, OdometryThatIsNotANumberIsPassedOver) {
  const Pose2 nowhere{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};
  for (const bool by_topic : {false, true}) {
    SensorInput input({}, false);
    input.add(link(0.0, "base_link", "laser", {}));
    const auto say = [&](double t_s, const Pose2& pose) {
      if (by_topic) {
        input.add(odometry(t_s, pose));
      } else {
        input.add_moving(link(t_s, "odom", "base_link", pose));
      }
    };
    say(1.0, {1.0, 0.0, 0.0});
    say(2.0, nowhere);
    say(3.0, {3.0, 0.0, 0.0});
    input.add(scan(2.0));
    const auto taken = input.take();
    ASSERT_EQ(taken.size(), 1U);
    expect_near(taken[0].odom_from_robot, {2.0, 0.0, 0.0});
  }
}

TEST(SensorInput, ASampleThatComesLateForgetsNoOdometry) {
  for (const bool by_topic : {false, true}) {
    SensorInput input({}, true);
    input.add(link(0.0, "base_link", "laser", {}));
    const auto say = [&](double t_s) {
      if (by_topic) {
        input.add(odometry(t_s, {t_s, 0.0, 0.0}));
      } else {
        input.add_moving(link(t_s, "odom", "base_link", {t_s, 0.0, 0.0}));
      }
    };
    for (int i = 0; i <= 100; ++i) say(0.1 * i);
    say(9.35);
    say(2.0);
    say(10.1);
    say(3.0);
    input.add(scan(5.25));
    input.add(scan(9.5));
    const auto taken = input.take();
    ASSERT_EQ(taken.size(), 2U);
    EXPECT_NEAR(taken[0].odom_from_robot.x, 5.25, 1e-9);
    EXPECT_NEAR(taken[1].odom_from_robot.x, 9.5, 1e-9);
  }
}

TEST(SensorInput, AClockThatIsSetBackBeginsOdometryAnewAndWhatWaitsGoesOn) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i <= 10; ++i) input.add(odometry(100.0 + 0.1 * i, {50.0, 0.0, 0.0}));
  input.add(scan(101.05));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(odometry(95.0, {60.0, 0.0, 0.0}));
  EXPECT_THAT(input.take(), IsEmpty()) << "one old sample may just be late";
  input.add(odometry(95.1, {61.0, 0.0, 0.0}));
  auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].scan.stamp, at(101.05));
  input.add(odometry(95.2, {62.0, 0.0, 0.0}));
  input.add(scan(95.05));
  input.add(scan(95.15));
  taken = input.take();
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_NEAR(taken[0].odom_from_robot.x, 60.5, 1e-9);
  EXPECT_NEAR(taken[1].odom_from_robot.x, 61.5, 1e-9);
}

TEST(SensorInput, OdometryAcrossAHoleIsNotMadeUp) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  for (const double t : {0.0, 0.5, 6.0, 6.5}) input.add(odometry(t, {t, 0.0, 0.0}));
  for (const double t : {0.25, 1.25, 3.0, 5.5, 6.25}) input.add(scan(t));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 4U);
  EXPECT_NEAR(taken[0].odom_from_robot.x, 0.25, 1e-9);
  EXPECT_NEAR(taken[1].odom_from_robot.x, 0.5, 1e-9) << "the nearest one";
  EXPECT_NEAR(taken[2].odom_from_robot.x, 6.0, 1e-9);
  EXPECT_NEAR(taken[3].odom_from_robot.x, 6.25, 1e-9);
}

TEST(SensorInput, AScannerThatFallsSilentIsWaitedForOnce) {
  SensorInputConfig config;
  config.scan_topics = {"front", "back"};
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 100; ++i) input.add(odometry(0.1 * i, {}));
  for (int i = 0; i < 10; ++i) {
    input.add(scan(1.0 + 0.1 * i), 0);
    input.add(scan(1.0 + 0.1 * i), 1);
  }
  EXPECT_THAT(input.take(), SizeIs(20));
  input.add(scan(2.0), 0);
  EXPECT_THAT(input.take(), IsEmpty()) << "the other one is due";
  for (int i = 1; i < 4; ++i) input.add(scan(2.0 + 0.1 * i), 0);
  EXPECT_THAT(input.take(), SizeIs(4));
  Health health;
  input.diagnose(health);
  EXPECT_THAT(health.message(), HasSubstr("back is silent"));
  input.add(scan(2.4), 0);
  EXPECT_THAT(input.take(), SizeIs(1));
  input.add(scan(2.5), 1);
  input.add(scan(2.5), 0);
  EXPECT_THAT(input.take(), SizeIs(2));
}

TEST(SensorInput, TimeThatRunsBackwardsBeginsOdometryAnew) {
  SensorInput input({}, false);
  input.add(link(0.0, "base_link", "laser", {}));
  input.add(odometry(100.0, {5.0, 0.0, 0.0}));
  input.add(odometry(1.0, {0.0, 0.0, 0.0}));
  input.add(odometry(3.0, {1.0, 0.0, 0.0}));
  input.add(scan(2.0));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  expect_near(taken[0].odom_from_robot, {0.5, 0.0, 0.0});
}

TEST(SensorInput, AScanWhoseAnglesAreNoNumbersIsRefusedAndTheNextIsTaken) {
  SensorInput input({}, false);
  input.add(link(0.0, "base_link", "laser", {}));
  sensor_msgs::msg::LaserScan broken = scan(1.0);
  broken.angle_increment(std::numeric_limits<float>::quiet_NaN());
  EXPECT_THROW(input.add(broken), InputError);
  EXPECT_TRUE(input.take().empty());
  sensor_msgs::msg::LaserScan empty = scan(2.0);
  empty.ranges().clear();
  input.add(empty);
  input.add(scan(3.0));
  EXPECT_EQ(input.take().size(), 2U);
}

}  // namespace
}  // namespace strata::runtime
