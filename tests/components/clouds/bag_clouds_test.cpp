// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/bag_clouds.hpp"

#include <string>
#include <vector>

#include "strata_idl/tf2_msgs.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/transform_history.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::clouds {
namespace {

Pose3 at_x(double x) {
  Pose3 pose;
  pose.translation.x() = x;
  return pose;
}

Stamp s(double seconds) { return Stamp::from_seconds(seconds); }

TEST(TransformHistory, InterpolatesBetweenMomentsAlongTheChain) {
  log::TransformHistory history;
  history.add_fixed("base", "lidar", at_x(0.25));
  history.add("odom", "base", s(2.0), at_x(2.0));
  history.add("/odom", "base", s(1.0), at_x(1.0));
  history.add("map", "odom", s(1.0), at_x(10.0));
  history.add("map", "odom", s(2.0), at_x(10.0));
  EXPECT_NEAR(history.find("map", "lidar", s(1.5)).value().translation.x(), 11.75, 1e-12);
  EXPECT_NEAR(history.find("map", "lidar", s(2.0)).value().translation.x(), 12.25, 1e-12);
  EXPECT_FALSE(history.find("map", "lidar", s(2.1)));
  EXPECT_FALSE(history.find("map", "camera", s(1.5)));
  EXPECT_TRUE(history.knows("map"));
  EXPECT_FALSE(history.knows("world"));
}

TEST(TransformHistory, DoesNotBridgeGapsAndForgetsWhatIsOld) {
  log::TransformHistory history(5.0, 1.0);
  history.add("map", "base", s(0.0), at_x(0.0));
  history.add("map", "base", s(3.0), at_x(3.0));
  EXPECT_FALSE(history.find("map", "base", s(1.0)));
  for (int i = 0; i < 40; ++i) history.add("map", "base", s(4.0 + i), at_x(4.0 + i));
  EXPECT_FALSE(history.find("map", "base", s(4.0)));
  EXPECT_TRUE(history.find("map", "base", s(40.5)));
}

TEST(TransformHistory, GoesOnAfterAClockWasSetBackAndKeepsWhatComesLate) {
  log::TransformHistory history(5.0, 1.0);
  for (int i = 0; i < 100; ++i) history.add("map", "base", s(1000.0 + 0.1 * i), at_x(i));
  history.add("map", "base", s(1001.0), at_x(-1.0));
  history.add("map", "base", s(1010.0), at_x(100.0));
  EXPECT_TRUE(history.find("map", "base", s(1009.55))) << "one came late";
  for (int i = 0; i < 100; ++i) history.add("map", "base", s(10.0 + 0.1 * i), at_x(i));
  EXPECT_NEAR(history.find("map", "base", s(19.85)).value().translation.x(), 98.5, 1e-9);
  EXPECT_FALSE(history.find("map", "base", s(1009.5)));
}

void write_bag(const std::filesystem::path& folder, log::BagStorage storage) {
  log::BagWriter writer(folder, storage);
  const auto tf = writer.add_topic({"/tf", "tf2_msgs/msg/TFMessage"});
  const auto points = writer.add_topic({"/points", "sensor_msgs/msg/PointCloud2"});
  for (int i = 0; i < 3; ++i) {
    geometry_msgs::msg::TransformStamped stamped;
    stamped.header(convert::make_header(s(i), "map"));
    stamped.child_frame_id("lidar");
    stamped.transform(convert::to_transform(Pose2{1.0 * i, 0.0, 0.0}));
    tf2_msgs::msg::TFMessage message;
    message.transforms({stamped});
    writer.write(tf, s(i), convert::to_cdr(message));
  }
  const auto cloud = [&](double time_s, const std::string& frame) {
    return convert::to_message({{1.0F, 2.0F, 3.0F}}, s(time_s), frame);
  };
  writer.write(points, s(0.6), convert::to_cdr(cloud(0.5, "lidar")));
  writer.write(points, s(0.8), convert::to_cdr(cloud(0.7, "elsewhere")));
  auto fieldless = cloud(1.0, "lidar");
  fieldless.fields().clear();
  writer.write(points, s(1.1), convert::to_cdr(fieldless));
  writer.write(points, s(1.6), convert::to_cdr(cloud(1.5, "lidar")));
  writer.close();
}

TEST(BagClouds, HaveThePosesOfTfAndCountWhatHasNone) {
  for (const log::BagStorage storage : {log::BagStorage::kSqlite3, log::BagStorage::kMcap}) {
    const test::TemporaryDirectory folder;
    write_bag(folder.path() / "bag", storage);
    const auto reader = CloudReader::open(folder.path() / "bag");
    volume::Cloud cloud;
    ASSERT_TRUE(reader->next(cloud));
    EXPECT_EQ(cloud.stamp, s(0.5));
    EXPECT_NEAR(cloud.map_from_sensor.translation.x(), 0.5, 1e-12);
    EXPECT_EQ(cloud.points_m.at(0), Eigen::Vector3f(1.0F, 2.0F, 3.0F));
    ASSERT_TRUE(reader->next(cloud));
    EXPECT_EQ(cloud.stamp, s(1.5));
    EXPECT_FALSE(reader->next(cloud));
    EXPECT_EQ(reader->report().clouds, 2U);
    EXPECT_EQ(reader->report().clouds_without_pose, 1U);
    EXPECT_EQ(reader->report().unreadable_clouds, 1U);  // the one without fields
    EXPECT_EQ(reader->report().bad_lines, 2U);
    EXPECT_THAT(reader->report().first_bad,
                testing::HasSubstr("nothing connects elsewhere to map"));
  }
}

TEST(BagClouds, RefuseABagWithoutClouds) {
  const test::TemporaryDirectory folder;
  log::BagWriter writer(folder.path() / "bag", log::BagStorage::kMcap);
  writer.add_topic({"/tf", "tf2_msgs/msg/TFMessage"});
  writer.close();
  EXPECT_THROW((void)CloudReader::open(folder.path() / "bag"), InputError);
}

}  // namespace
}  // namespace strata::clouds
