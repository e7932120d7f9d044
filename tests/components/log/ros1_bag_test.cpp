// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/bag_copy.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"
#include "tests/support/same_scan.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using test_log::Ros1BagMaker;
using test_log::Ros1End;
using test_log::Ros1Format;
using test_log::Ros1Topic;
using test_log::write_text;
using ::testing::Contains;
using ::testing::HasSubstr;

void expect_same_log(const LogContent& a, const LogContent& b) {
  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (std::size_t i = 0; i < a.observations.size(); ++i) {
    strata::test::expect_same_scan(a.observations[i].scan, b.observations[i].scan);
    ASSERT_EQ(a.observations[i].odom_from_robot, b.observations[i].odom_from_robot) << i;
    ASSERT_EQ(a.observations[i].has_odometry, b.observations[i].has_odometry);
  }
  ASSERT_EQ(a.odometry.size(), b.odometry.size());
  for (std::size_t i = 0; i < a.odometry.size(); ++i) {
    ASSERT_EQ(a.odometry[i].stamp, b.odometry[i].stamp);
    ASSERT_EQ(a.odometry[i].odom_from_robot, b.odometry[i].odom_from_robot);
  }
  EXPECT_EQ(a.scan_frame, b.scan_frame);
  EXPECT_EQ(a.robot_frame, b.robot_frame);
  EXPECT_EQ(a.odom_frame, b.odom_frame);
}

class Ros1Bag : public ::testing::Test {
 protected:
  fs::path write(const std::string& bytes, const std::string& name = "drive.bag") {
    write_text(folder_.path() / name, bytes);
    return folder_.path() / name;
  }
  /// A log of 60 scans as a bag of ROS 2.
  fs::path rosbag2() {
    const fs::path folder = folder_.path() / "ros2";
    write_bag(folder, test_log::make_log(60, 180, 7), BagStorage::kSqlite3, BagCompression::kNone);
    return folder;
  }
  strata::test::TemporaryDirectory folder_;
};

class Ros1BagOfALog : public Ros1Bag,
                      public ::testing::WithParamInterface<std::tuple<const char*, Ros1End>> {};

TEST_P(Ros1BagOfALog, GivesTheSameObservationsAsTheBagOfRos2) {
  const auto& [compression, end] = GetParam();
  const fs::path original = rosbag2();
  const fs::path bag =
      write(test_log::ros1_bag_of(original, {.compression = compression, .end = end}));
  EXPECT_EQ(detect_format(bag), LogFormat::kRos1Bag);
  ReadReport report;
  const LogContent content = read_log(bag, {}, &report);
  expect_same_log(content, read_log(original));
  EXPECT_STREQ(format_name(report.format), "ROS 1 bag");
  EXPECT_EQ(report.mounting_source, "tf_static");
  EXPECT_EQ(report.odometry_source, "/odom");
  if (std::string(compression) != "none") {
    EXPECT_THAT(report.storage, HasSubstr(compression));
  }
  EXPECT_EQ(report.bad_lines, end == Ros1End::kWhole ? 0U : 1U) << report.first_bad;
  if (end != Ros1End::kWhole) {
    EXPECT_THAT(report.warnings, Contains(HasSubstr(bag.string() + ": byte ")));
    EXPECT_THAT(report.storage, HasSubstr("without a whole index"));
  }
}

INSTANTIATE_TEST_SUITE_P(All, Ros1BagOfALog,
                         ::testing::Combine(::testing::Values("none", "bz2", "lz4"),
                                            ::testing::Values(Ros1End::kWhole, Ros1End::kNoIndex,
                                                              Ros1End::kUnfinishedChunk)));

TEST_F(Ros1Bag, MessagesComeInOrderOfTheirStampsAcrossChunks) {
  Ros1BagMaker maker({.chunk_bytes = 300});
  std::vector<std::int64_t> sorted;
  for (std::int64_t i = 0; i < 50; ++i) {
    maker.write(test_log::kRos1Chat, {(i * 7 % 50 + 1) * 1'000'000'000},
                test_log::Ros1Bytes().text("x").bytes());
    sorted.push_back((i + 1) * 1'000'000'000);
  }
  EXPECT_EQ(test_log::read_bag(write(maker.finish())).stamps(), sorted);
}

TEST_F(Ros1Bag, PartsInAFolderAreOneLog) {
  const fs::path folder = folder_.path() / "parts";
  fs::create_directory(folder);
  for (int part = 0; part < 12; ++part) {
    Ros1BagMaker maker;
    maker.write(test_log::kRos1Chat, {part * 1'000'000'000L},
                test_log::Ros1Bytes().text("x").bytes());
    write_text(folder / ("drive_" + std::to_string(part) + ".bag"), maker.finish());
  }
  const auto stamps = test_log::read_bag(folder).stamps();
  EXPECT_EQ(stamps.size(), 12U);
  EXPECT_TRUE(std::is_sorted(stamps.begin(), stamps.end()));
}

/// base_link_from_laser on /tf, as ROS 1 published mountings before it had /tf_static.
std::string link(std::int64_t second, double x_m) {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(convert::to_transform_stamped(
      {second * 1'000'000'000}, Pose2{x_m, 0.0, 0.0}, "/base_link", "/laser"));
  return test_log::ros1_message(message, 0);
}
std::string scan_at(std::int64_t second) {
  Scan scan = test_log::make_log(1, 5, 1).observations.front().scan;
  scan.stamp = {second * 1'000'000'000};
  return test_log::ros1_message(convert::to_message(scan, "/laser"), 0);
}

TEST_F(Ros1Bag, AMountingThatComesAgainOnTfIsTaken) {
  for (const double step_m : {0.0, 0.01}) {
    Ros1BagMaker maker;
    for (std::int64_t i = 1; i < 9; ++i) {
      maker.write(test_log::kRos1OldTransforms, {i * 1'000'000'000},
                  link(i, 0.3 + step_m * static_cast<double>(i)));
      maker.write(test_log::kRos1Scan, {i * 1'000'000'000 + 1}, scan_at(i));
    }
    ReadReport report;
    const auto scans = read_observations(write(maker.finish()), {}, &report);
    const bool is_steady = step_m == 0.0;
    EXPECT_DOUBLE_EQ(scans.front().scan.robot_from_laser.x, is_steady ? 0.3 : 0.0);
    EXPECT_EQ(report.mounting_source, is_steady ? "tf" : "assumed");
  }
}

TEST_F(Ros1Bag, WhatIsNotKnownKeepsItsBytesAndItsNames) {
  Ros1BagMaker maker;
  maker.write({"/weld", "acme_msgs/Weld", "0123456789abcdef0123456789abcdef"}, {1}, "\x01\x02");
  maker.write(test_log::kRos1Chat, {2}, test_log::Ros1Bytes().text("x").bytes());
  const fs::path file = write(maker.finish());
  const auto bag = test_log::read_bag(file);
  EXPECT_EQ(bag.topics[0].type, "acme_msgs/Weld");
  EXPECT_EQ(bag.topics[0].serialization_format, kRos1Format);
  EXPECT_EQ(bag.messages[0].second, (std::vector<std::uint8_t>{1, 2}));
  EXPECT_EQ(bag.damage.count, 0U);
  // ROS 2 opens no bag in which only some of the topics are its own.
  const auto report = copy_bag(file, folder_.path() / "copy", {});
  EXPECT_THAT(report.left_out, ::testing::ElementsAre(HasSubstr("/weld (1 acme_msgs/Weld)")));
  EXPECT_EQ(test_log::read_bag(folder_.path() / "copy").topics.size(), 1U);
}

TEST_F(Ros1Bag, AnotherDefinitionOfAKnownTypeIsNotTakenForIt) {
  Ros1BagMaker maker;
  maker.write({"/scan", "sensor_msgs/LaserScan", "0123456789abcdef0123456789abcdef"}, {1}, "old");
  const auto bag = test_log::read_bag(write(maker.finish()));
  EXPECT_EQ(bag.topics[0].serialization_format, kRos1Format);
  EXPECT_THAT(bag.damage.first, HasSubstr("/scan is not read"));
}

TEST_F(Ros1Bag, PosesAreATrajectory) {
  const auto poses = [](const char* topic) {
    Ros1Topic named = test_log::kRos1Truth;
    named.name = topic;
    return named;
  };
  geometry_msgs::msg::PoseStamped pose;
  pose.header().stamp().sec(3);
  pose.pose().position().x(1.5);
  pose.pose().orientation().z(1.0);
  Ros1BagMaker maker;
  maker.write(poses("/vicon"), {1}, test_log::ros1_message(pose, 0));
  pose.pose().position().x(2.5);
  maker.write(poses("/goal"), {1}, test_log::ros1_message(pose, 0));
  const std::string file = write(maker.finish());
  const auto vicon = read_trajectory(file + ":/vicon", 1.0);
  ASSERT_EQ(vicon.size(), 1U);
  EXPECT_EQ(vicon[0].stamp.ns, 4'000'000'000);
  EXPECT_EQ(vicon[0].pose.x, 1.5);
  EXPECT_NEAR(std::abs(vicon[0].pose.theta), 3.14159265, 1e-6);
  EXPECT_EQ(read_trajectory(file + ":/goal")[0].pose.x, 2.5);
  try {
    (void)read_trajectory(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 topics of poses"));
    EXPECT_THAT(error.remedy(), HasSubstr(file + ":/vicon"));
  }
  EXPECT_THROW((void)read_trajectory(file + ":/none"), InputError);
}

class Ros1RealLog : public Ros1Bag, public ::testing::WithParamInterface<const char*> {};

TEST_P(Ros1RealLog, GivesTheSameObservationsBitForBit) {
  STRATA_REQUIRE_DATA(original, GetParam());
  ReadReport expected;
  const LogContent content = read_log(original, {}, &expected);
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const fs::path bag = write(
        test_log::ros1_bag_of(original, {.compression = compression, .chunk_bytes = 768 * 1024}));
    ReadReport report;
    expect_same_log(read_log(bag, {}, &report), content);
    EXPECT_EQ(report.bad_lines, 0U) << report.first_bad;
    EXPECT_EQ(report.warnings, expected.warnings);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Ros1RealLog,
                         ::testing::Values("wean_hall/ros2_run2/ros2_db3", "olin_mac/take_2_db3"));

TEST_F(Ros1Bag, HasTheTruthOfWean) {
  STRATA_REQUIRE_DATA(original, "wean_hall/ros2_run2/ros2_db3");
  const auto truth = read_trajectory(write(test_log::ros1_bag_of(original)));
  const auto expected = read_trajectory(original);
  ASSERT_EQ(truth.size(), 2251U);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    ASSERT_EQ(truth[i].stamp, expected[i].stamp);
    ASSERT_EQ(truth[i].pose, expected[i].pose);
  }
}

}  // namespace
}  // namespace strata::log
