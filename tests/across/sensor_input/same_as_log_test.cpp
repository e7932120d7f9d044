// SPDX-License-Identifier: Apache-2.0
/// What a live robot gets is what the reader gets out of a log of the same messages, bit for bit.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cloud_messages.hpp"
#include "components/player/log_player.hpp"
#include "core/base/error.hpp"
#include "tests/across/sensor_input/recorded_robot.hpp"

namespace strata::runtime {
namespace {

using test::at;
using test::odometry;
using test::on_a_bend;
using test::RecordedRobot;
using test::sweep;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Odometry at 50 Hz from before the first scan until after the last one.
void drive(RecordedRobot& robot, double until_s) {
  for (int i = 0; 0.02 * i < until_s; ++i) {
    robot.say(0.02 * i, "/odom", odometry(0.02 * i, on_a_bend(0.02 * i)));
  }
}

void scan(RecordedRobot& robot, double until_s, const std::string& topic = "/scan",
          const std::string& frame = "laser", double first_s = 0.113) {
  for (double t = first_s; t < until_s; t += 0.1) robot.say(t + 0.045, topic, sweep(t, frame));
}

/// still_waiting: scans that a live robot holds back when nothing comes any more, since other
/// scanners may still send older ones.
void expect_same(const RecordedRobot& robot, std::size_t scans,
                 const SensorInputConfig& config = {}, const log::ReadOptions& options = {},
                 std::size_t still_waiting = 0) {
  auto recorded = robot.by_the_log(options);
  ASSERT_EQ(recorded.size(), scans);
  recorded.resize(scans - still_waiting);
  test::expect_same_bits(robot.live(config), recorded);
}

TEST(SameAsLog, ALaserUpsideDownWhoseSweepsAreUndistorted) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", test::rolled_link("base_link", "laser", 0.2, 0.1));
  drive(robot, 2.0);
  scan(robot, 1.8);
  expect_same(robot, 17);
  const auto taken = robot.live();
  ASSERT_FALSE(taken.empty());
  // The first beam of the message, to the laser's right, is to the robot's left.
  EXPECT_FLOAT_EQ(taken[0].scan.angle_min_rad, -1.0F);
  EXPECT_GT(taken[0].scan.ranges_m.front(), taken[0].scan.ranges_m.back());
}

/// The laser's mounting, and the base's at x_m on its footprint.
tf2_msgs::msg::TFMessage on_a_footprint(double x_m) {
  tf2_msgs::msg::TFMessage fixed = test::link(0.0, "base_link", "laser", {0.2, 0.0, 0.0});
  fixed.transforms().push_back(
      convert::to_transform_stamped(at(0.0), {x_m, 0.0, 0.0}, "base_footprint", "base_link"));
  return fixed;
}

TEST(SameAsLog, OdometryFromTfIsOfTheRobotsOwnChain) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", on_a_footprint(0.05));
  for (int i = 0; i < 100; ++i) {
    const double t = 0.02 * i;
    robot.say(t, "/tf", test::link(t, "odom", "base_footprint", on_a_bend(t)));
    // A camera's odometry in the same frame, and somebody else's robot; their clocks are behind.
    robot.say(t, "/tf", test::link(t - 0.35, "odom", "a_camera_base", {50.0, 0.0, 0.0}));
    robot.say(t, "/tf", test::link(t - 0.35, "odom", "zebra/base_link", {70.0, 0.0, 0.0}));
    robot.say(t, "/tf", test::link(t, "map", "odom", {9.0, 9.0, 1.0}));
  }
  scan(robot, 1.8);
  expect_same(robot, 17);
  const auto taken = robot.live();
  ASSERT_FALSE(taken.empty());
  EXPECT_NEAR(taken[0].odom_from_robot.x, on_a_bend(0.113).x + 0.05, 0.01);
}

TEST(SameAsLog, OdometryOfTheFootprintIsCarriedToTheRobotsFrame) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", on_a_footprint(0.3));
  for (int i = 0; i < 100; ++i) {
    robot.say(0.02 * i, "/odom", odometry(0.02 * i, {1.0, 2.0, 0.0}, "base_footprint"));
  }
  scan(robot, 1.8);
  expect_same(robot, 17);
  const auto taken = robot.live();
  ASSERT_FALSE(taken.empty());
  EXPECT_EQ(taken[0].odom_from_robot, (Pose2{1.3, 2.0, 0.0}));
  EXPECT_EQ(taken[0].scan.robot_from_laser, (Pose2{0.2, 0.0, 0.0}));
}

TEST(SameAsLog, AMountingThatNobodyPublishesIsTakenForTheOriginAndTold) {
  RecordedRobot robot;
  drive(robot, 8.0);  // for longer than a mounting is waited for
  scan(robot, 7.5);
  expect_same(robot, 74);
  EXPECT_THAT(robot.report.warnings,
              ElementsAre(HasSubstr("tf_static does not connect laser to base_link")));
  EXPECT_EQ(robot.warnings, robot.report.warnings);
}

TEST(SameAsLog, OdometryThatComesLateAndAMomentThatHasNone) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "laser", {0.2, 0.0, 0.0}));
  for (int i = 0; i < 300; ++i) {
    const double t = 0.02 * i;
    if (t > 1.0 && t < 4.0) continue;
    // Every fifth sample is overtaken by the next.
    robot.say(i % 5 == 1 ? t + 0.021 : t, "/odom", odometry(t, on_a_bend(t)));
  }
  scan(robot, 5.5);
  const auto recorded = robot.by_the_log();
  EXPECT_GT(robot.report.scans_without_odometry, 0U);
  EXPECT_LT(robot.report.scans_without_odometry, 12U);
  SensorInputConfig config;
  config.max_waiting_scans = 60;
  test::expect_same_bits(robot.live(config), recorded);
}

TEST(SameAsLog, WhatIsNotANumberIsPassedOverAndNamed) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "laser", {0.2, 0.0, 0.0}));
  robot.say(0.001, "/tf_static", test::link(0.0, "base_link", "laser", {kNan, 0.0, 0.0}));
  for (int i = 0; i < 100; ++i) {
    const double t = 0.02 * i;
    Pose2 pose = on_a_bend(t);
    if (i % 9 == 4) pose.y = kNan;
    robot.say(t, "/tf", test::link(t, "odom", "base_link", pose));
  }
  scan(robot, 1.8);
  expect_same(robot, 17);
  EXPECT_EQ(robot.report.bad_lines, 12U);
  EXPECT_THAT(robot.report.first_bad, HasSubstr("transform of laser in base_link is not finite"));
  EXPECT_THAT(robot.warnings,
              ElementsAre(HasSubstr("/tf_static: the transform of laser in base_link is not"),
                          HasSubstr("/tf: the transform of base_link in odom is not finite")));
}

TEST(SameAsLog, ScannersOnTopicsOfTheirOwn) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "front", {0.3, 0.2, 0.7}));
  robot.say(0.0, "/tf_static", test::rolled_link("base_link", "back", -0.3, -0.2));
  drive(robot, 8.0);
  scan(robot, 7.8, "/front/scan", "front", 0.113);
  scan(robot, 7.8, "/back/scan", "back", 0.171);
  // Of another rate, and mounted nobody knows where.
  for (double t = 0.02; t < 7.75; t += 0.037) {
    robot.say(t + 0.041, "/side/scan", sweep(t, "laser"));
  }
  log::ReadOptions options;
  options.scan_topics = {"/front/scan", "/back/scan", "/side/scan"};
  SensorInputConfig config;
  config.scan_topics = options.scan_topics;
  expect_same(robot, 77 + 77 + 209, config, options, 1);
  EXPECT_EQ(robot.report.scan_topic, "/front/scan, /back/scan, /side/scan");
  EXPECT_THAT(robot.warnings, ElementsAre(HasSubstr("connect laser to base_link")));
}

TEST(SameAsLog, ScannersThatTurnInStepAndComeInEitherOrder) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "front", {0.3, 0.2, 0.7}));
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "back", {-0.3, -0.2, 3.0}));
  drive(robot, 4.0);
  for (int i = 1; i < 36; ++i) {
    const double t = 0.1 * i;
    const double front_late = i % 3 == 0 ? 0.03 : 0.0;
    const double back_late = i % 4 == 0 ? 0.03 : 0.0;
    const double apart = i % 5 == 0 ? -0.001 : i % 5 == 1 ? 0.001 : 0.0;
    robot.say(t + 0.045 + front_late, "/front/scan", sweep(t, "front"));
    robot.say(t + 0.045 + back_late, "/back/scan", sweep(t + apart, "back"));
  }
  log::ReadOptions options;
  options.scan_topics = {"/front/scan", "/back/scan"};
  SensorInputConfig config;
  config.scan_topics = options.scan_topics;
  expect_same(robot, 70, config, options);
}

TEST(SameAsLog, TwoFramesOnOneTopicAreTwoScanners) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "front", {0.3, 0.2, 0.7}));
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "back", {-0.3, -0.2, 3.0}));
  drive(robot, 2.0);
  scan(robot, 1.8, "/scan", "front", 0.113);
  scan(robot, 1.8, "/scan", "back", 0.171);
  expect_same(robot, 34);
  const auto taken = robot.live();
  ASSERT_GE(taken.size(), 2U);
  EXPECT_NE(taken[0].scan.robot_from_laser, taken[1].scan.robot_from_laser);
}

/// A wall in the sensor's frame, floor below it, with a time for each point.
sensor_msgs::msg::PointCloud2 cloud(double t_s, const std::string& frame) {
  std::vector<Eigen::Vector3f> points;
  convert::CloudColumns columns;
  for (int i = 0; i < 400; ++i) {
    const float y = -2.0F + 0.01F * static_cast<float>(i);
    for (const float z : {-1.0F, -0.75F, -0.6F}) {
      points.push_back({2.0F + 0.05F * static_cast<float>(t_s), y, z});
      columns.offset_s.push_back(1e-4F * static_cast<float>(i));
    }
  }
  return convert::to_message(points, at(t_s), frame, columns);
}

TEST(SameAsLog, CloudsAreSlicedAndUndistorted) {
  RecordedRobot robot;
  drive(robot, 2.0);
  for (int i = 1; i < 18; ++i) {
    robot.say(0.1 * i + 0.06, "/points", cloud(0.1 * i, "lidar"));
    robot.say(0.1 * i + 0.048, "/scan", sweep(0.1 * i + 0.003, "laser"));
  }
  // Whatever comes first.
  tf2_msgs::msg::TFMessage fixed = test::link(0.0, "base_link", "laser", {0.2, 0.0, 0.0});
  fixed.transforms().push_back(
      convert::to_transform_stamped(at(0.0), {0.1, 0.0, 0.3}, "base_link", "lidar"));
  fixed.transforms()[1].transform().translation().z(1.0);
  robot.say(0.25, "/tf_static", fixed);
  log::ReadOptions options;
  options.scan_topics = {"/scan", "/points"};
  SensorInputConfig config;
  config.scan_topics = {"/scan"};
  config.cloud_topics = {"/points"};
  expect_same(robot, 34, config, options);
  options.scan_topics = {"/points"};
  config.scan_topics.clear();
  expect_same(robot, 17, config, options);
  const auto taken = robot.live(config);
  ASSERT_EQ(taken.size(), 17U);
  EXPECT_GT(count_beams(taken[0].scan).hits, 100U);
  EXPECT_NEAR(taken[0].scan.robot_from_laser.x, 0.1, 1e-12);
  EXPECT_NEAR(taken[0].scan.robot_from_laser.theta, 0.3, 1e-12);
}

TEST(SameAsLog, ABagWithoutScansNamesItsClouds) {
  RecordedRobot robot;
  drive(robot, 1.0);
  robot.say(0.5, "/points", cloud(0.4, "lidar"));
  try {
    (void)robot.by_the_log();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--scan-topic"));
  }
}

TEST(SameAsLog, AReplayOfSeveralScannersKeepsTheirBits) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", test::link(0.0, "base_link", "front", {0.3, 0.2, 0.7}));
  robot.say(0.0, "/tf_static", test::rolled_link("base_link", "back", -0.3, -0.2));
  drive(robot, 2.0);
  scan(robot, 1.8, "/front/scan", "front", 0.113);
  scan(robot, 1.8, "/back/scan", "back", 0.113);
  log::ReadOptions options;
  options.scan_topics = {"/front/scan", "/back/scan"};
  const auto recorded = robot.by_the_log(options);
  ASSERT_EQ(recorded.size(), 34U);
  SensorInput input({}, false);
  std::vector<Observation> taken;
  player::Outputs outputs;
  outputs.clock = [](const auto&) {};
  outputs.tf = [](const auto&) {};
  outputs.tf_static = [&](const auto& message) { input.add(message); };
  outputs.odometry = [&](const auto& message) { input.add(message); };
  outputs.scan = [&](const auto& message) {
    input.add(message);
    for (Observation& observation : input.take()) taken.push_back(std::move(observation));
  };
  player::LogPlayer player(recorded, outputs);
  for (std::size_t i = 0; i < recorded.size(); ++i) player.publish(i);
  test::expect_same_bits(taken, recorded);
}

}  // namespace
}  // namespace strata::runtime
