// SPDX-License-Identifier: Apache-2.0
#include "components/convert/message_definitions.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/idl_texts.hpp"

namespace strata::convert {
namespace {

TEST(MessageDefinitions, AreWrittenAsRos2WritesThem) {
  const std::string separator = std::string(80, '=') + "\n";
  EXPECT_EQ(message_definition("sensor_msgs/msg/LaserScan"),
            "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 "
            "angle_increment\nfloat32 time_increment\nfloat32 scan_time\nfloat32 range_min\n"
            "float32 range_max\nfloat32[] ranges\nfloat32[] intensities\n" +
                separator +
                "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
                separator + "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
  EXPECT_THAT(message_definition("geometry_msgs/msg/PoseWithCovariance"),
              ::testing::StartsWith("geometry_msgs/Pose pose\nfloat64[36] covariance\n"));
  EXPECT_THAT(message_definition("nav_msgs/msg/OccupancyGrid"),
              ::testing::HasSubstr("int8[] data"));
}

TEST(MessageDefinitions, OurOwnTypesAreKnownWithTheirDependenciesOnce) {
  const std::string text = message_definition("strata_msgs/msg/PatchMap");
  EXPECT_THAT(text,
              ::testing::StartsWith("std_msgs/Header header\nstrata_msgs/ReflectionGrid base\n"
                                    "strata_msgs/Submap[] submaps\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("MSG: strata_msgs/Submap\nint32 id\nstrata_msgs/CellRect "
                                         "rect\nbyte[] contradictory\n"));
  const std::string cell_rect = "MSG: strata_msgs/CellRect\n";
  EXPECT_EQ(text.find(cell_rect), text.rfind(cell_rect));
  EXPECT_THAT(message_definition("strata_msgs/msg/Step"),
              ::testing::HasSubstr("uint32 STEP_CYCLE=2\n"));
  EXPECT_THAT(message_definition("strata_msgs/msg/Step"), ::testing::HasSubstr("uint32 kind\n"));
}

TEST(MessageDefinitions, EveryStructOfTheIdlHasOne) {
  std::size_t structs = 0;
  for (const std::string_view idl : idl_texts()) {
    const std::size_t module = idl.find("module ") + 7;
    const std::string package(idl.substr(module, idl.find(' ', module) - module));
    for (std::size_t at = 0; (at = idl.find("@final struct ", at)) != std::string_view::npos;) {
      at += std::string_view("@final struct ").size();
      const std::string name(idl.substr(at, idl.find(' ', at) - at));
      EXPECT_NE(message_definition(package + "/msg/" + name), "") << package << " " << name;
      ++structs;
    }
  }
  EXPECT_GT(structs, 40U);
}

TEST(MessageDefinitions, AForeignTypeHasNone) {
  EXPECT_EQ(message_definition("foreign_msgs/msg/Thing"), "");
}

}  // namespace
}  // namespace strata::convert
