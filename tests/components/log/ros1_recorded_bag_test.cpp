// SPDX-License-Identifier: Apache-2.0
/// What bags have that robots and simulators of ROS 1 recorded, and the format does not tell.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using test_log::Ros1BagMaker;
using test_log::Ros1Topic;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kSecond = 1'000'000'000;

class RecordedRos1Bag : public ::testing::Test {
 protected:
  fs::path write(const std::string& bytes) {
    test_log::write_text(folder_.path() / "drive.bag", bytes);
    return folder_.path() / "drive.bag";
  }
  static void put_scan(Ros1BagMaker& maker, std::int64_t second) {
    Scan scan = test_log::make_log(1, 5, 1).observations.front().scan;
    scan.stamp = {second * kSecond};
    maker.write(test_log::kRos1Scan, {second * kSecond + 1},
                test_log::ros1_message(convert::to_message(scan, "laser"), 0));
  }
  static void put_odometry(Ros1BagMaker& maker, const std::string& name, std::int64_t second,
                           double x_m) {
    Ros1Topic topic = test_log::kRos1Odometry;
    topic.name = name;
    nav_msgs::msg::Odometry odometry;
    odometry.header().stamp().sec(static_cast<std::int32_t>(second));
    odometry.header().frame_id("odom");
    odometry.pose().pose().position().x(x_m);
    odometry.pose().pose().orientation().w(1.0);
    maker.write(topic, {second * kSecond}, test_log::ros1_message(odometry, 0));
  }
  static void put_link(Ros1BagMaker& maker, std::int64_t second, const Pose2& pose,
                       const std::string& parent, const std::string& child) {
    tf2_msgs::msg::TFMessage message;
    message.transforms().push_back(
        convert::to_transform_stamped({second * kSecond}, pose, parent, child));
    maker.write(test_log::kRos1OldTransforms, {second * kSecond},
                test_log::ros1_message(message, 0));
  }
  strata::test::TemporaryDirectory folder_;
  ReadReport report_;
};

TEST_F(RecordedRos1Bag, WhoseIndexStatesMoreThanItHasLosesNoChunk) {
  write_bag(folder_.path() / "ros2", test_log::make_log(60, 180, 7), BagStorage::kSqlite3);
  const auto whole = test_log::read_bag(write(test_log::ros1_bag_of(folder_.path() / "ros2")));
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const auto bag = test_log::read_bag(write(test_log::ros1_bag_of(
        folder_.path() / "ros2", {.compression = compression, .stated_entry_bytes = 20})));
    EXPECT_EQ(bag.damage.count, 0U) << bag.damage.first;
    EXPECT_EQ(bag.messages, whole.messages) << compression;
  }
}

TEST_F(RecordedRos1Bag, OfWhichAChunkStatesTooMuchLosesNoOther) {
  write_bag(folder_.path() / "ros2", test_log::make_log(60, 180, 7), BagStorage::kSqlite3);
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::string bytes =
        test_log::ros1_bag_of(folder_.path() / "ros2", {.compression = compression});
    const auto whole = test_log::read_bag(write(bytes));
    const std::size_t chunk = bytes.find("compression=", bytes.size() / 3) - 16;
    const std::size_t length = chunk + 4 + static_cast<unsigned char>(bytes[chunk]);
    for (const std::size_t place :
         {length + 1, length + 3}) {  // into what follows; out of the file
      std::string spoilt = bytes;
      spoilt[place] = '\x7F';
      const auto bag = test_log::read_bag(write(spoilt));
      EXPECT_EQ(bag.damage.count, 1U);
      EXPECT_THAT(bag.damage.first, HasSubstr("byte " + std::to_string(chunk)));
      EXPECT_EQ(bag.messages, whole.messages) << compression;
    }
  }
}

TEST_F(RecordedRos1Bag, OfASimulatorHasTheTruthNotTakenForOdometry) {
  for (const bool has_odometry : {true, false}) {
    Ros1BagMaker maker;
    for (std::int64_t i = 1; i < 6; ++i) {
      put_odometry(maker, "/base_pose_ground_truth", i, 7.0);
      if (has_odometry) put_odometry(maker, "/guardian/odom", i, 1.0);
      put_scan(maker, i);
    }
    const fs::path bag = write(maker.finish());
    report_ = {};
    const auto scans = read_observations(bag, {}, &report_);
    ASSERT_EQ(scans.size(), 5U);
    EXPECT_EQ(scans.front().has_odometry, has_odometry);
    EXPECT_EQ(report_.odometry_source, has_odometry ? "/guardian/odom" : "none");
    EXPECT_DOUBLE_EQ(scans.front().odom_from_robot.x, has_odometry ? 1.0 : 0.0);
    EXPECT_THAT(report_.warnings, Contains(HasSubstr("/base_pose_ground_truth")));
    ReadOptions named;
    named.odom_topic = "/base_pose_ground_truth";
    EXPECT_DOUBLE_EQ(read_observations(bag, named).front().odom_from_robot.x, 7.0);
  }
}

TEST_F(RecordedRos1Bag, OfThePr2HasItsOdometryInAFrameOfAnotherName) {
  Ros1BagMaker maker;
  for (std::int64_t i = 1; i < 6; ++i) {
    put_link(maker, i, {0.5 * static_cast<double>(i), 0.0, 0.0}, "/odom_combined",
             "/base_footprint");
    put_link(maker, i, {0.1, 0.0, 0.0}, "/base_footprint", "/base_link");
    put_link(maker, i, {0.3, 0.0, 0.0}, "/base_link", "/laser");
    put_scan(maker, i);
  }
  const LogContent log = read_log(write(maker.finish()), {}, &report_);
  EXPECT_EQ(report_.odometry_source, "tf");
  EXPECT_EQ(log.odom_frame, "odom_combined");
  ASSERT_EQ(log.observations.size(), 5U);
  EXPECT_NEAR(log.observations[2].odom_from_robot.x, 1.6, 1e-9);
  EXPECT_DOUBLE_EQ(log.observations[2].scan.robot_from_laser.x, 0.3);
}

TEST_F(RecordedRos1Bag, WithAFrameCalledOdomTakesNoOther) {
  Ros1BagMaker maker;
  for (std::int64_t i = 1; i < 6; ++i) {
    put_link(maker, i, {9.0 * static_cast<double>(i), 0.0, 0.0}, "/odom_filtered", "/camera");
    put_link(maker, i, {0.5 * static_cast<double>(i), 0.0, 0.0}, "/odom", "/base_link");
    put_scan(maker, i);
  }
  const LogContent log = read_log(write(maker.finish()), {}, &report_);
  EXPECT_EQ(log.odom_frame, "odom");
  EXPECT_DOUBLE_EQ(log.observations[2].odom_from_robot.x, 1.5);
}

// A servo holds the scanner of one robot to 0.001 degrees.
TEST_F(RecordedRos1Bag, AMountingThatAServoHoldsIsTaken) {
  for (const double step_rad : {2e-5, 0.02}) {
    Ros1BagMaker maker;
    for (std::int64_t i = 1; i < 9; ++i) {
      put_link(maker, i, {0.3, 0.0, i % 2 == 0 ? 0.0 : step_rad}, "base_link", "laser");
      put_scan(maker, i);
    }
    report_ = {};
    const auto scans = read_observations(write(maker.finish()), {}, &report_);
    const bool is_held = step_rad < 1e-3;
    EXPECT_DOUBLE_EQ(scans.front().scan.robot_from_laser.x, is_held ? 0.3 : 0.0);
    EXPECT_EQ(report_.mounting_source, is_held ? "tf" : "assumed");
    if (!is_held) {
      EXPECT_THAT(report_.warnings, Contains(HasSubstr("moves")));
      EXPECT_THAT(report_.warnings, Not(Contains(HasSubstr("does not connect"))));
    }
  }
}

}  // namespace
}  // namespace strata::log
