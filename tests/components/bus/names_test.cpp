// SPDX-License-Identifier: Apache-2.0
#include "components/bus/names.hpp"

#include "strata_idl/geometry_msgsPubSubTypes.h"
#include "strata_idl/nav_msgsPubSubTypes.h"
#include "strata_idl/sensor_msgsPubSubTypes.h"
#include "strata_idl/strata_msgsPubSubTypes.h"
#include "strata_idl/tf2_msgsPubSubTypes.h"
#include <gtest/gtest.h>

#include "components/bus/message_types.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

TEST(Names, ExpandRelativePrivateAndAbsolute) {
  EXPECT_EQ(expand_name("scan", "/robot1", "node"), "/robot1/scan");
  EXPECT_EQ(expand_name("scan", "/", "node"), "/scan");
  EXPECT_EQ(expand_name("scan", "", "node"), "/scan");
  EXPECT_EQ(expand_name("~/state", "/robot1", "node"), "/robot1/node/state");
  EXPECT_EQ(expand_name("/tf", "/robot1", "node"), "/tf");
}

TEST(Names, RemapWhenTheLeftSideExpandsToTheSameName) {
  const Remappings rules = {{"scan", "/front/scan"}, {"/robot1/odom", "wheels"}};
  EXPECT_EQ(resolve_name("scan", "/robot1", "n", rules), "/front/scan");
  EXPECT_EQ(resolve_name("/robot1/scan", "/robot1", "n", rules), "/front/scan");
  EXPECT_EQ(resolve_name("odom", "/robot1", "n", rules), "/robot1/wheels");
  EXPECT_EQ(resolve_name("map", "/robot1", "n", rules), "/robot1/map");
}

TEST(Names, RefuseWhatRos2Refuses) {
  EXPECT_THROW((void)expand_name("", "/", "n"), ConfigError);
  EXPECT_THROW((void)expand_name("a b", "/", "n"), ConfigError);
  EXPECT_THROW((void)expand_name("//scan", "/", "n"), ConfigError);
}

TEST(Names, GoToTheWireAndBack) {
  EXPECT_EQ(wire_topic("/robot1/scan"), "rt/robot1/scan");
  EXPECT_EQ(topic_from_wire("rt/robot1/scan"), "/robot1/scan");
  EXPECT_EQ(topic_from_wire("ros_discovery_info"), "");
  EXPECT_EQ(wire_type("sensor_msgs/msg/LaserScan"), "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_EQ(type_from_wire("sensor_msgs::msg::dds_::LaserScan_"), "sensor_msgs/msg/LaserScan");
  EXPECT_EQ(type_from_wire("LaserScan"), "");
}

template <typename T, typename Generated>
void expect_generated_name() {
  EXPECT_EQ(wire_type(MessageType<T>::name), Generated().getName());
}

TEST(Names, OfTypesAreThoseOfTheGeneratedCode) {
  expect_generated_name<sensor_msgs::msg::LaserScan, sensor_msgs::msg::LaserScanPubSubType>();
  expect_generated_name<nav_msgs::msg::Odometry, nav_msgs::msg::OdometryPubSubType>();
  expect_generated_name<nav_msgs::msg::OccupancyGrid, nav_msgs::msg::OccupancyGridPubSubType>();
  expect_generated_name<tf2_msgs::msg::TFMessage, tf2_msgs::msg::TFMessagePubSubType>();
  expect_generated_name<geometry_msgs::msg::PoseWithCovarianceStamped,
                        geometry_msgs::msg::PoseWithCovarianceStampedPubSubType>();
  expect_generated_name<strata_msgs::msg::Step, strata_msgs::msg::StepPubSubType>();
  expect_generated_name<strata_msgs::msg::PatchMap, strata_msgs::msg::PatchMapPubSubType>();
}

}  // namespace
}  // namespace strata::bus
