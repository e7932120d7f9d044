// SPDX-License-Identifier: Apache-2.0
#include "components/log/message_fields.hpp"

#include <limits>
#include <string>
#include <vector>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/strata_msgs.h"
#include "strata_idl/tf2_msgs.h"
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::log {
namespace {

/// The value of a field by its path.
FieldValue value_of(const std::string& type, const std::vector<std::uint8_t>& cdr,
                    const std::string& path) {
  const auto values = message_fields(type, cdr);
  for (std::size_t i = 0; values && i < values->size(); ++i) {
    if (field_path(type, cdr, i) == path) return (*values)[i];
  }
  ADD_FAILURE() << type << " has no " << path;
  return {};
}

TEST(MessageFields, FindNumbersAndTextsAcrossAlignmentAndSequences) {
  sensor_msgs::msg::LaserScan scan;
  scan.header(convert::make_header(Stamp{3'000'000'007LL}, "front"));
  scan.range_max(10.5F);
  scan.ranges({1.0F, 2.5F, std::numeric_limits<float>::infinity()});
  const auto cdr = convert::to_cdr(scan);
  const std::string type = "sensor_msgs/msg/LaserScan";
  EXPECT_EQ(value_of(type, cdr, "header.stamp.sec").number, 3.0);
  EXPECT_EQ(value_of(type, cdr, "header.stamp.nanosec").number, 7.0);
  EXPECT_EQ(value_of(type, cdr, "header.frame_id").text, "front");
  EXPECT_EQ(value_of(type, cdr, "range_max").number, 10.5);
  EXPECT_EQ(value_of(type, cdr, "ranges.length").number, 3.0);
  EXPECT_EQ(value_of(type, cdr, "ranges[1]").number, 2.5);
  EXPECT_EQ(value_of(type, cdr, "ranges[2]").number, std::numeric_limits<double>::infinity());
  EXPECT_EQ(value_of(type, cdr, "intensities.length").number, 0.0);
}

TEST(MessageFields, FindNestedMessagesAndFixedArrays) {
  nav_msgs::msg::Odometry odometry =
      convert::to_odometry(Stamp{}, {1.5, -2.0, 0.0}, "odom", "base");
  odometry.pose().covariance()[35] = 0.25;
  const auto cdr = convert::to_cdr(odometry);
  EXPECT_EQ(value_of("nav_msgs/msg/Odometry", cdr, "pose.pose.position.y").number, -2.0);
  EXPECT_EQ(value_of("nav_msgs/msg/Odometry", cdr, "pose.covariance[35]").number, 0.25);
  EXPECT_EQ(value_of("nav_msgs/msg/Odometry", cdr, "child_frame_id").text, "base");

  strata_msgs::msg::SubmapStates states;
  states.states().resize(2);
  states.states()[1].probability({0.25, 0.75});
  EXPECT_EQ(
      value_of("strata_msgs/msg/SubmapStates", convert::to_cdr(states), "states[1].probability[1]")
          .number,
      0.75);
}

/// Every definition says what the generated code writes, to the last byte.
template <typename T>
void expect_whole(const std::string& type) {
  const auto cdr = convert::to_cdr(T());
  EXPECT_TRUE(message_fields(type, cdr).has_value()) << type;
  for (std::size_t cut = 1; cut <= 4 && cdr.size() > 8; ++cut) {
    const std::span<const std::uint8_t> part(cdr.data(), cdr.size() - 4 - cut);
    EXPECT_THROW((void)message_fields(type, part), InputError) << type << " without " << cut;
  }
}

TEST(MessageFields, RefuseBytesThatAreCutShort) {
  expect_whole<strata_msgs::msg::ScanPose>("strata_msgs/msg/ScanPose");
  expect_whole<strata_msgs::msg::LabeledScan>("strata_msgs/msg/LabeledScan");
  expect_whole<strata_msgs::msg::ReflectionGrid>("strata_msgs/msg/ReflectionGrid");
  expect_whole<strata_msgs::msg::LocalizationHealth>("strata_msgs/msg/LocalizationHealth");
  expect_whole<nav_msgs::msg::OccupancyGrid>("nav_msgs/msg/OccupancyGrid");
  EXPECT_THROW((void)message_fields("tf2_msgs/msg/TFMessage", {}), InputError);
}

TEST(MessageFields, AreNothingForATypeThatIsNotKnown) {
  const std::vector<std::uint8_t> cdr = {0, 1, 0, 0, 1};
  EXPECT_FALSE(message_fields("strange_msgs/msg/Thing", cdr).has_value());
  EXPECT_EQ(field_path("strange_msgs/msg/Thing", cdr, 0), "");
}

}  // namespace
}  // namespace strata::log
