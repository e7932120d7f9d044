// SPDX-License-Identifier: Apache-2.0
#include "components/log/ros1_messages.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"

namespace strata::log {
namespace {

using test_log::ros1_message;
using test_log::Ros1Topic;

template <std::size_t size>
Bytes bytes_of(const char (&text)[size]) {
  return {text, text + size - 1};
}
Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

Bytes converted(const Ros1Topic& topic, const Bytes& message) {
  const auto type = find_ros1_type(topic.type, topic.md5);
  if (!type) throw std::runtime_error(topic.type);
  return ros1_to_cdr(*type, message, "here");
}

std_msgs::msg::Header header() {
  std_msgs::msg::Header header;
  header.stamp().sec(1);
  header.stamp().nanosec(2);
  header.frame_id("laser");
  return header;
}

// Written by hand from the definition of sensor_msgs/LaserScan.
TEST(Ros1Messages, AScanIsTakenFromTheBytesThatRos1Wrote) {
  const Bytes message = bytes_of(
      "\x07\x00\x00\x00"                                  // seq
      "\x01\x00\x00\x00\x02\x00\x00\x00"                  // stamp
      "\x05\x00\x00\x00laser"                             // frame_id
      "\x00\x00\x80\xBF"                                  // angle_min -1
      "\x00\x00\x80\x3F"                                  // angle_max 1
      "\x00\x00\x00\x3F"                                  // angle_increment 0.5
      "\x00\x00\x80\x3E"                                  // time_increment 0.25
      "\x00\x00\x00\x40"                                  // scan_time 2
      "\x00\x00\x00\x3E"                                  // range_min 0.125
      "\x00\x00\xA0\x41"                                  // range_max 20
      "\x02\x00\x00\x00\x00\x00\x40\x40\x00\x00\x80\x7F"  // ranges 3, +Inf
      "\x01\x00\x00\x00\x00\x00\x80\x40");                // intensities 4
  sensor_msgs::msg::LaserScan scan;
  scan.header(header());
  scan.angle_min(-1.0F);
  scan.angle_max(1.0F);
  scan.angle_increment(0.5F);
  scan.time_increment(0.25F);
  scan.scan_time(2.0F);
  scan.range_min(0.125F);
  scan.range_max(20.0F);
  scan.ranges({3.0F, std::numeric_limits<float>::infinity()});
  scan.intensities({4.0F});
  EXPECT_EQ(bytes_of(ros1_message(scan, 7)), message);
  EXPECT_EQ(converted(test_log::kRos1Scan, message), convert::to_cdr(scan));
}

TEST(Ros1Messages, EveryTypeBecomesTheBytesThatRos2Writes) {
  nav_msgs::msg::Odometry odometry;
  odometry.header(header());
  odometry.child_frame_id("base_footprint");
  odometry.pose().pose().position().x(1.5);
  odometry.pose().pose().orientation().w(1.0);
  odometry.twist().twist().angular().z(-0.25);
  for (std::size_t i = 0; i < 36; ++i) {
    odometry.pose().covariance()[i] = static_cast<double>(i);
    odometry.twist().covariance()[i] = -static_cast<double>(i);
  }
  EXPECT_EQ(converted(test_log::kRos1Odometry, bytes_of(ros1_message(odometry, 3))),
            convert::to_cdr(odometry));

  tf2_msgs::msg::TFMessage transforms;
  for (const char* child : {"a", "bc", "def", "ghij"}) {  // every alignment
    geometry_msgs::msg::TransformStamped transform;
    transform.header(header());
    transform.child_frame_id(child);
    transform.transform().translation().y(2.5);
    transform.transform().rotation().w(1.0);
    transforms.transforms().push_back(transform);
  }
  const Bytes of_tf = bytes_of(ros1_message(transforms, 4));
  EXPECT_EQ(converted(test_log::kRos1Transforms, of_tf), convert::to_cdr(transforms));
  EXPECT_EQ(converted(test_log::kRos1OldTransforms, of_tf), convert::to_cdr(transforms));

  geometry_msgs::msg::PoseStamped pose;
  pose.header(header());
  pose.pose().position().z(9.0);
  EXPECT_EQ(converted(test_log::kRos1Truth, bytes_of(ros1_message(pose, 0))),
            convert::to_cdr(pose));

  sensor_msgs::msg::PointCloud2 cloud;
  cloud.header(header());
  cloud.height(1);
  cloud.width(1);
  for (const char* name : {"x", "yy", "intensity"}) {
    sensor_msgs::msg::PointField field;
    field.name(name);
    field.datatype(7);
    field.count(1);
    cloud.fields().push_back(field);
  }
  cloud.point_step(12);
  cloud.row_step(12);
  cloud.data({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  cloud.is_dense(true);
  EXPECT_EQ(converted(test_log::kRos1Cloud, bytes_of(ros1_message(cloud, 0))),
            convert::to_cdr(cloud));
}

TEST(Ros1Messages, BytesThatAreNoMessageAreRefusedWithTheirPlace) {
  geometry_msgs::msg::PoseStamped pose;
  pose.header(header());
  const Bytes whole = bytes_of(ros1_message(pose, 0));
  Bytes long_one = whole;
  long_one.push_back(0);
  Bytes late = whole;
  late[7] = 0x80;  // 2^31 s: the year 2038
  Bytes endless = whole;
  endless[15] = 0xFF;  // of the frame's length
  const Bytes short_one(whole.begin(), whole.end() - 1);
  for (const Bytes& bytes : {long_one, late, endless, short_one, Bytes{}}) {
    try {
      (void)converted(test_log::kRos1Truth, bytes);
      FAIL() << bytes.size();
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), "here");
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

TEST(Ros1Messages, ATypeIsKnownByItsDefinitionToo) {
  EXPECT_TRUE(find_ros1_type("sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"));
  EXPECT_TRUE(find_ros1_type("sensor_msgs/LaserScan", "*"));
  EXPECT_FALSE(find_ros1_type("sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f368"));
  EXPECT_FALSE(find_ros1_type("acme_msgs/Weld", "*"));
}

}  // namespace
}  // namespace strata::log
