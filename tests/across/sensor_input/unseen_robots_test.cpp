// SPDX-License-Identifier: Apache-2.0
/// Robots that say something odd: it is told with the remedy, or refused, never taken in silence.
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/runtime/sensor_input.hpp"
#include "core/base/error.hpp"
#include "tests/across/sensor_input/recorded_robot.hpp"

namespace strata::runtime {
namespace {

using test::link;
using test::odometry;
using test::RecordedRobot;
using test::scan;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Odometry at 50 Hz, the robot standing.
void stand(RecordedRobot& robot, double until_s, const std::string& child = "base_link") {
  for (double t = 0.0; t < until_s; t += 0.02) robot.say(t, "/odom", odometry(t, {}, child));
}

void expect_both_tell(RecordedRobot& robot, const std::string& what) {
  (void)robot.live();
  EXPECT_THAT(robot.warnings, ElementsAre(HasSubstr(what)));
  (void)robot.by_the_log();
  EXPECT_THAT(robot.report.warnings, ElementsAre(HasSubstr(what)));
}

std::string refusal_of(const sensor_msgs::msg::LaserScan& message) {
  SensorInput input({}, true);
  try {
    input.add(message);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(UnseenRobots, ScansWhoseBeamsAllPointOneWayAreRefused) {
  auto message = scan(1.0);
  message.angle_increment(0.0F);
  EXPECT_THAT(refusal_of(message), HasSubstr("a scan's 3 beams have an angle_increment of 0"));
  message.ranges({1.0F});
  EXPECT_EQ(refusal_of(message), "");
}

TEST(UnseenRobots, AnglesInDegreesAreRefusedAndBeamsThatOverlapAreNot) {
  auto message = scan(1.0);
  message.angle_increment(1.0F);
  message.ranges(std::vector<float>(360, 1.0F));
  EXPECT_THAT(refusal_of(message), AllOf(HasSubstr("go around 57 times"), HasSubstr("radians")));
  message.angle_increment(-1.0F);
  EXPECT_THAT(refusal_of(message), HasSubstr("go around 57 times"));
  message.angle_increment(static_cast<float>(2.2 * std::numbers::pi / 360.0));
  EXPECT_EQ(refusal_of(message), "");
}

/// All round, from angle_min to angle_max.
sensor_msgs::msg::LaserScan round_scan(double t, float increment, float angle_max) {
  auto message = scan(t);
  message.angle_min(-3.14F);
  message.angle_increment(increment);
  message.angle_max(angle_max);
  message.ranges(std::vector<float>(360, 1.0F));
  return message;
}

TEST(UnseenRobots, AnAngleMaxThatTheBeamsContradictIsToldOnce) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", link(0.0, "base_link", "laser", {}));
  stand(robot, 2.0);
  for (int i = 1; i < 4; ++i) robot.say(0.3 * i, "/scan", round_scan(0.3 * i, 0.00875F, 3.14F));
  expect_both_tell(robot, "angle_max is 3.14 rad, but 360 beams");
}

TEST(UnseenRobots, AnAngleMaxThatIsABeamOffOrAWholeTurnOrNotToldIsUsual) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", link(0.0, "base_link", "laser", {}));
  stand(robot, 2.0);
  const float increment = 0.01745F;
  const float end = -3.14F + 359.0F * increment;
  const std::vector<float> usual{end, end + increment, end - 6.283185F, 0.0F, -3.14F};
  double t = 0.1;
  for (const float angle_max : usual) {
    robot.say(t, "/scan", round_scan(t, increment, angle_max));
    t += 0.1;
  }
  EXPECT_THAT(robot.live(), SizeIs(usual.size()));
  EXPECT_THAT(robot.warnings, IsEmpty());
  EXPECT_THAT(robot.by_the_log(), SizeIs(usual.size()));
  EXPECT_THAT(robot.report.warnings, IsEmpty());
}

tf2_msgs::msg::TFMessage rolled_by(double degrees) {
  tf2_msgs::msg::TFMessage message = link(0.0, "base_link", "laser", {});
  const double half = degrees * std::numbers::pi / 360.0;
  message.transforms()[0].transform().rotation().w(std::cos(half));
  message.transforms()[0].transform().rotation().x(std::sin(half));
  return message;
}

TEST(UnseenRobots, AScannerThatIsTiltedIsToldOnce) {
  for (const double degrees : {20.0, 90.0, 160.0}) {
    SCOPED_TRACE(degrees);
    RecordedRobot robot;
    robot.say(0.0, "/tf_static", rolled_by(degrees));
    stand(robot, 2.0);
    for (int i = 1; i < 4; ++i) robot.say(0.3 * i, "/scan", scan(0.3 * i));
    const std::string tilt = degrees == 90.0 ? "90" : "20";
    expect_both_tell(robot, "laser is tilted by " + tilt + " degrees");
  }
}

TEST(UnseenRobots, AScannerUpsideDownOrADegreeOffIsNotTilted) {
  for (const double degrees : {1.0, 180.0, 178.0}) {
    RecordedRobot robot;
    robot.say(0.0, "/tf_static", rolled_by(degrees));
    stand(robot, 2.0);
    robot.say(0.3, "/scan", scan(0.3));
    EXPECT_THAT(robot.live(), SizeIs(1));
    EXPECT_THAT(robot.warnings, IsEmpty()) << degrees;
  }
}

TEST(UnseenRobots, OdometryThatIsResetWithinASweepDoesNotBendIt) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 100; ++i) {
    const double t = 0.02 * i;
    robot.say(t, "/odom", odometry(t, t < 1.0 ? Pose2{4.0, -3.0, 1.5} : Pose2{}));
  }
  robot.say(0.99, "/scan", test::sweep(0.99));
  const auto taken = robot.live();
  ASSERT_THAT(taken, SizeIs(1));
  EXPECT_EQ(taken[0].scan.ranges_m, test::sweep(0.99).ranges());
  test::expect_same_bits(taken, robot.by_the_log());
}

/// A robot whose frames carry its name.
RecordedRobot robot1(bool has_odometry_topic) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", link(0.0, "robot1/base_link", "robot1/laser", {0.2, 0.0, 0.0}));
  for (double t = 0.0; t < 9.0; t += 0.02) {
    robot.say(t, "/tf", link(t, "robot1/odom", "robot1/base_link", {t, 0.0, 0.0}));
    if (!has_odometry_topic) continue;
    robot.say(t, "/odom", odometry(t, {t, 0.0, 0.0}, "robot1/base_link"));
  }
  for (double t = 0.1; t < 8.5; t += 0.1) robot.say(t, "/scan", scan(t, "robot1/laser"));
  return robot;
}

TEST(UnseenRobots, OfFramesWithARobotsNameAndOdometryOnTfItIsToldWhatToSet) {
  const RecordedRobot robot = robot1(false);
  EXPECT_FALSE(robot.live().front().has_odometry);
  EXPECT_THAT(robot.warnings,
              testing::UnorderedElementsAre(
                  AllOf(HasSubstr("tf_static does not connect robot1/laser to base_link"),
                        HasSubstr("It hangs on robot1/base_link: set robot_frame")),
                  AllOf(HasSubstr("no odometry comes on"), HasSubstr("/tf has robot1/odom"),
                        HasSubstr("set tf_odometry_frame and odometry_frame"))));
  SensorInputConfig config;
  config.robot_frame = "robot1/base_link";
  config.tf_odometry_frame = "robot1/odom";
  const auto taken = robot.live(config);
  EXPECT_THAT(robot.warnings, IsEmpty());
  EXPECT_TRUE(taken.front().has_odometry);
  EXPECT_EQ(taken.front().scan.robot_from_laser, (Pose2{0.2, 0.0, 0.0}));
}

TEST(UnseenRobots, TheReaderFindsOdometryOnTfInAFrameWithARobotsName) {
  const RecordedRobot robot = robot1(false);
  const auto recorded = robot.by_the_log();
  EXPECT_THAT(robot.report.warnings, IsEmpty());
  EXPECT_TRUE(recorded.front().has_odometry);
  EXPECT_EQ(recorded.front().scan.robot_from_laser, (Pose2{0.2, 0.0, 0.0}));
}

TEST(UnseenRobots, FramesWithARobotsNameNeedNothingWhereOdometryHasATopic) {
  const RecordedRobot robot = robot1(true);
  const auto taken = robot.live();
  EXPECT_THAT(robot.warnings, IsEmpty());
  EXPECT_EQ(taken.front().scan.robot_from_laser, (Pose2{0.2, 0.0, 0.0}));
}

/// Ten seconds of scans that say `ahead_s` more than odometry's clock, or nothing at all.
std::vector<std::string> told_of_clocks(double ahead_s, bool stamps_scans = true,
                                        SensorInputConfig config = {}) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", link(0.0, "base_link", "laser", {}));
  for (double t = 0.0; t < 20.0; t += 0.02) robot.say(t, "/odom", odometry(t + 100.0, {}));
  for (double t = 8.0; t < 18.0; t += 0.1) {
    robot.say(t, "/scan", scan(stamps_scans ? t + 100.0 + ahead_s : 0.0));
  }
  (void)robot.live(config);
  return robot.warnings;
}

TEST(UnseenRobots, ScansByAClockFarAheadOfOdometrysAreTold) {
  EXPECT_THAT(told_of_clocks(4.0),
              ElementsAre(AllOf(HasSubstr("s after the newest odometry of odom"),
                                HasSubstr("find none of their moment"),
                                HasSubstr("set odometry_lag_s: -"))));
}

TEST(UnseenRobots, ScansByAClockFarBehindOdometrysAreTold) {
  EXPECT_THAT(told_of_clocks(-5.0),
              ElementsAre(AllOf(HasSubstr("before the newest odometry of odom"),
                                HasSubstr("get odometry of another moment"),
                                HasSubstr("set odometry_lag_s: 5.0"))));
}

TEST(UnseenRobots, ScansWithoutStampsAreTold) {
  EXPECT_THAT(told_of_clocks(0.0, false),
              ElementsAre(AllOf(HasSubstr("before the newest odometry"),
                                HasSubstr("find none of their moment"),
                                testing::Not(HasSubstr("odometry_lag_s")))));
}

TEST(UnseenRobots, NothingIsToldOfTheClocksOfARobotThatKeepsThem) {
  EXPECT_THAT(told_of_clocks(0.0), IsEmpty());
  EXPECT_THAT(told_of_clocks(0.3), IsEmpty());
  EXPECT_THAT(told_of_clocks(-1.0), IsEmpty());
  SensorInputConfig config;
  config.odometry_lag_s = 5.0;
  EXPECT_THAT(told_of_clocks(-5.0, true, config), IsEmpty());
}

TEST(UnseenRobots, ABurstOfOldScansAfterAComponentWasBusyIsNoGapBetweenClocks) {
  RecordedRobot robot;
  robot.say(0.0, "/tf_static", link(0.0, "base_link", "laser", {}));
  stand(robot, 20.0);
  for (double t = 1.0; t < 18.0; t += 0.1) {
    robot.say(t > 5.0 && t < 9.0 ? 9.0 : t, "/scan", scan(t));
  }
  (void)robot.live();
  EXPECT_THAT(robot.warnings, IsEmpty());
}

TEST(UnseenRobots, AScannersOwnNumberForNoReturnCanBeSaid) {
  SensorInputConfig config;
  config.max_range_m = 65.0;
  config.use_odometry = false;
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "laser", {}));
  auto message = scan(1.0);
  message.range_max(100.0F);
  message.ranges({1.0F, 65.533F, 64.0F});
  input.add(message);
  const auto taken = input.take();
  ASSERT_THAT(taken, SizeIs(1));
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_THAT(taken[0].scan.ranges_m, ElementsAre(1.0F, inf, 64.0F));
  EXPECT_EQ(taken[0].scan.range_max_m, 65.0F);
}

TEST(UnseenRobots, ADriverThatCountsInItsFrameIsToldOnceAndTheOthersGoOn) {
  SensorInputConfig config;
  config.scan_topics = {"/front", "/rear"};
  config.use_odometry = false;
  SensorInput input(config, true);
  input.add(link(0.0, "base_link", "rear", {}));
  constexpr int kMost = static_cast<int>(ScanQueue::kMaxFrames);
  std::vector<std::string> warnings;
  int taken = 0;
  for (int i = 0; i < 4 * kMost; ++i) {
    const std::string frame = "laser_" + std::to_string(i);
    input.add(link(0.0, "base_link", frame, {}));
    input.add(scan(0.1 * i, frame), 0);
    input.add(scan(0.1 * i + 0.05, "rear"), 1);
    taken += static_cast<int>(input.take().size());
    for (const std::string& warning : input.take_warnings()) warnings.push_back(warning);
  }
  EXPECT_THAT(warnings, ElementsAre(AllOf(HasSubstr("/front: scans come in ever new frames"),
                                          HasSubstr("frame_id"))));
  EXPECT_GT(taken, 4 * kMost) << "those of the other topic go on, beside the first frames";
  Health health;
  input.diagnose(health);
  EXPECT_THAT(health.values(), testing::Contains(std::pair<std::string, std::string>(
                                   "scans in ever new frames", std::to_string(3 * kMost))));
}

}  // namespace
}  // namespace strata::runtime
