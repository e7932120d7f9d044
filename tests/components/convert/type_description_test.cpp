// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/message_definitions.hpp"
#include "components/convert/type_description_messages.hpp"
#include "components/convert/type_hash.hpp"

namespace strata::convert {
namespace {

using type_description_interfaces::srv::GetTypeDescription_Request;

GetTypeDescription_Request request_for(const std::string& type, const std::string& hash = "",
                                       bool with_sources = true) {
  GetTypeDescription_Request request;
  request.type_name(type);
  request.type_hash(hash);
  request.include_type_sources(with_sources);
  return request;
}

TEST(TypeDescription, TellsTheFieldsOfAMessageAndOfAllThatItContains) {
  const auto response = answer(request_for("nav_msgs/msg/OccupancyGrid"));
  ASSERT_TRUE(response.successful()) << response.failure_reason();
  const auto& type = response.type_description().type_description();
  EXPECT_EQ(type.type_name(), "nav_msgs/msg/OccupancyGrid");
  ASSERT_EQ(type.fields().size(), 3U);
  EXPECT_EQ(type.fields()[1].name(), "info");
  EXPECT_EQ(type.fields()[1].type().type_id(), 1);
  EXPECT_EQ(type.fields()[1].type().nested_type_name(), "nav_msgs/msg/MapMetaData");
  EXPECT_EQ(type.fields()[2].type().type_id(), 146) << "int8, in a sequence";
  std::vector<std::string> names;
  for (const auto& each : response.type_description().referenced_type_descriptions()) {
    names.push_back(each.type_name());
  }
  EXPECT_THAT(names,
              ::testing::ElementsAre("builtin_interfaces/msg/Time", "geometry_msgs/msg/Point",
                                     "geometry_msgs/msg/Pose", "geometry_msgs/msg/Quaternion",
                                     "nav_msgs/msg/MapMetaData", "std_msgs/msg/Header"));
  ASSERT_EQ(response.type_sources().size(), 7U);
  EXPECT_EQ(response.type_sources()[0].encoding(), "msg");
  EXPECT_EQ(response.type_sources()[0].raw_file_contents(),
            "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n");
}

TEST(TypeDescription, TellsAServiceAsRos2Does) {
  const auto response = answer(request_for("std_srvs/srv/Empty"));
  ASSERT_TRUE(response.successful()) << response.failure_reason();
  const auto& fields = response.type_description().type_description().fields();
  ASSERT_EQ(fields.size(), 3U);
  EXPECT_EQ(fields[2].name(), "event_message");
  EXPECT_EQ(fields[2].type().nested_type_name(), "std_srvs/srv/Empty_Event");
  EXPECT_EQ(response.type_sources()[0].encoding(), "srv");
  EXPECT_EQ(response.type_sources()[0].raw_file_contents(), "---\n");
  for (const auto& source : response.type_sources()) {
    const bool is_implicit = source.type_name().find("Empty_") != std::string::npos;
    EXPECT_EQ(source.encoding() == "implicit" && source.raw_file_contents().empty(),
              is_implicit || source.type_name() == "service_msgs/msg/ServiceEventInfo")
        << source.type_name();
  }
}

TEST(TypeDescription, LeavesTheTextsOutWhenTheyAreNotWanted) {
  const auto response = answer(request_for("std_msgs/msg/Header", "", false));
  EXPECT_TRUE(response.successful());
  EXPECT_TRUE(response.type_sources().empty());
}

TEST(TypeDescription, IsGivenForItsOwnHashOnly) {
  const std::string type = "strata_msgs/msg/PatchMap";
  EXPECT_TRUE(answer(request_for(type, type_hash(type))).successful());
  const auto other = answer(request_for(type, type_hash("std_msgs/msg/Header")));
  EXPECT_FALSE(other.successful());
  EXPECT_THAT(other.failure_reason(), ::testing::HasSubstr(type_hash(type)));
  const auto unknown = answer(request_for("foreign_msgs/msg/Thing"));
  EXPECT_FALSE(unknown.successful());
  EXPECT_THAT(unknown.failure_reason(), ::testing::HasSubstr("foreign_msgs/msg/Thing"));
}

}  // namespace
}  // namespace strata::convert
