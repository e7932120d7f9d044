// SPDX-License-Identifier: Apache-2.0
#include "components/convert/type_hash.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/message_definitions.hpp"

namespace strata::convert {
namespace {

/// As ROS 2 Jazzy's own packages have them.
TEST(TypeHash, IsTheOneOfRos2) {
  EXPECT_EQ(type_hash("sensor_msgs/msg/LaserScan"),
            "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828");
  EXPECT_EQ(type_hash("std_msgs/msg/String"),
            "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
  EXPECT_EQ(type_hash("rosgraph_msgs/msg/Clock"),
            "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564");
  EXPECT_EQ(type_hash("tf2_msgs/msg/TFMessage"),
            "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
  EXPECT_EQ(type_hash("nav_msgs/msg/Odometry"),
            "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0");
}

/// As ROS 2 Jazzy tells them of every node.
TEST(TypeHash, OfAServiceIsTheOneOfRos2) {
  EXPECT_EQ(type_hash("rcl_interfaces/srv/GetParameters"),
            "RIHS01_bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc");
  EXPECT_EQ(type_hash("rcl_interfaces/srv/DescribeParameters"),
            "RIHS01_845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff");
  EXPECT_EQ(type_hash("rcl_interfaces/srv/GetParameterTypes"),
            "RIHS01_da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca");
  EXPECT_EQ(type_hash("rcl_interfaces/srv/ListParameters"),
            "RIHS01_3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d");
  EXPECT_EQ(type_hash("rcl_interfaces/srv/SetParameters"),
            "RIHS01_56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0");
  EXPECT_EQ(type_hash("rcl_interfaces/srv/SetParametersAtomically"),
            "RIHS01_0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd");
}

/// As rmw_cyclonedds, rmw_zenoh and recorded bags of Jazzy have them.
TEST(TypeHash, OfWhatEveryNodeOfRos2WritesIsTheOneOfRos2) {
  EXPECT_EQ(type_hash("rcl_interfaces/msg/Log"),
            "RIHS01_e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac");
  EXPECT_EQ(type_hash("rcl_interfaces/msg/ParameterEvent"),
            "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204");
  EXPECT_EQ(type_hash("rmw_dds_common/msg/ParticipantEntitiesInfo"),
            "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e");
}

TEST(TypeHash, GoesByTheNamesOfRos2WhereOursDiffer) {
  for (const std::string service : {"nav_msgs/srv/GetMap", "nav2_msgs/srv/LoadMap"}) {
    const std::string description = type_description(service);
    EXPECT_THAT(description, ::testing::HasSubstr(R"({"name": "map", )"));
    EXPECT_THAT(description, ::testing::Not(::testing::HasSubstr(R"("grid")")));
  }
  EXPECT_THAT(type_description("type_description_interfaces/srv/GetTypeDescription"),
              ::testing::HasSubstr(R"({"name": "nested_type_name", "type": {"type_id": 21, )"
                                   R"("capacity": 0, "string_capacity": 255,)"));
}

TEST(TypeHash, OfAServiceWeDoNotKnowIsNone) { EXPECT_EQ(type_hash("foreign_msgs/srv/Thing"), ""); }

TEST(TypeHash, DescribesATypeAsRep2016Says) {
  EXPECT_EQ(type_description("std_msgs/msg/Header"),
            R"({"type_description": {"type_name": "std_msgs/msg/Header", "fields": [)"
            R"({"name": "stamp", "type": {"type_id": 1, "capacity": 0, "string_capacity": 0, )"
            R"("nested_type_name": "builtin_interfaces/msg/Time"}}, )"
            R"({"name": "frame_id", "type": {"type_id": 17, "capacity": 0, "string_capacity": 0, )"
            R"("nested_type_name": ""}}]}, "referenced_type_descriptions": [)"
            R"({"type_name": "builtin_interfaces/msg/Time", "fields": [)"
            R"({"name": "sec", "type": {"type_id": 6, "capacity": 0, "string_capacity": 0, )"
            R"("nested_type_name": ""}}, )"
            R"({"name": "nanosec", "type": {"type_id": 7, "capacity": 0, "string_capacity": 0, )"
            R"("nested_type_name": ""}}]}]})");
}

TEST(TypeHash, TellsArraysFromSequencesAndLeavesConstantsOut) {
  EXPECT_THAT(type_description("geometry_msgs/msg/PoseWithCovariance"),
              ::testing::HasSubstr(R"("covariance", "type": {"type_id": 59, "capacity": 36,)"));
  EXPECT_THAT(type_description("nav_msgs/msg/OccupancyGrid"),
              ::testing::HasSubstr(R"("data", "type": {"type_id": 146, "capacity": 0,)"));
  ASSERT_THAT(message_definition("strata_msgs/msg/Step"), ::testing::HasSubstr("STEP_CYCLE=2"));
  EXPECT_THAT(type_description("strata_msgs/msg/Step"),
              ::testing::Not(::testing::HasSubstr("STEP_CYCLE")));
}

TEST(TypeHash, AForeignTypeHasNone) {
  EXPECT_EQ(type_description("foreign_msgs/msg/Thing"), "");
  EXPECT_EQ(type_hash("foreign_msgs/msg/Thing"), "");
}

}  // namespace
}  // namespace strata::convert
