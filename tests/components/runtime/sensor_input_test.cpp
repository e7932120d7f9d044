// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sensor_input.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

const double kPi = std::acos(-1.0);

Stamp at(double seconds) { return Stamp{} + Duration::from_seconds(seconds); }

tf2_msgs::msg::TFMessage link(double seconds, const std::string& parent, const std::string& child,
                              const Pose2& pose) {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(convert::to_transform_stamped(at(seconds), pose, parent, child));
  return message;
}

nav_msgs::msg::Odometry odometry(double seconds, const Pose2& pose) {
  nav_msgs::msg::Odometry message;
  message.header(convert::make_header(at(seconds), "odom"));
  message.pose().pose(convert::to_pose(pose));
  return message;
}

sensor_msgs::msg::LaserScan scan(double seconds, const std::string& frame = "laser") {
  sensor_msgs::msg::LaserScan message;
  message.header(convert::make_header(at(seconds), frame));
  message.angle_min(-1.0F);
  message.angle_max(1.0F);
  message.angle_increment(1.0F);
  message.range_max(10.0F);
  message.ranges({1.0F, 2.0F, 3.0F});
  return message;
}

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
    const auto say = [&](double seconds, const Pose2& pose) {
      if (by_topic) {
        input.add(odometry(seconds, pose));
      } else {
        input.add_moving(link(seconds, "odom", "base_link", pose));
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

TEST(SensorInput, WhenTooManyScansWaitTheOldestGoesWithoutOdometry) {
  SensorInputConfig config;
  config.most_waiting_scans = 2;
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 3; ++i) input.add(scan(1.0 + i));
  const auto taken = input.take();
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].scan.stamp, at(1.0));
  EXPECT_FALSE(taken[0].has_odometry);
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
