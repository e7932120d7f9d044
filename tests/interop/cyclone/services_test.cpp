// SPDX-License-Identifier: Apache-2.0
/// Our services asked by Cyclone DDS in the way of rmw_cyclonedds.
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/log/map_file.hpp"
#include "components/map_server/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/interop/cyclone/process.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {
namespace {

class CycloneServices : public testing::Test {
 protected:
  CycloneServices() {
    const auto file = folder_.path() / "room.yaml";
    log::write_map(file, make_reflection_grid(0.1, CellRect{{0, 0}, {4, 6}}));
    runtime::Registry registry;
    map_server::register_component(registry);
    host_ =
        make_host("{type: strata::MapServer, name: maps, namespace: /robot1, parameters: {map: '" +
                      file.string() + "', map_frame: floor2}}",
                  registry, make_participant());
  }
  TemporaryDirectory folder_;
  std::unique_ptr<runtime::Host> host_;
};

TEST_F(CycloneServices, LeadAComponentThroughItsLife) {
  CycloneProcess activate({"change_state", "/robot1/maps", "3"});
  EXPECT_EQ(activate.wait_for_line("success"), "success 1");
  Collector<nav_msgs::msg::OccupancyGrid> maps(make_participant(), "/robot1/map", "latched");
  EXPECT_EQ(maps.wait_for(1).size(), 1U);
}

TEST_F(CycloneServices, GiveParameters) {
  CycloneProcess get({"get_parameter", "/robot1/maps", "map_frame"});
  EXPECT_EQ(get.wait_for_line("value"), "value 4 'floor2' 0 0");
}

/// Who asks while others ask gets the own reply, whatever its way.
TEST_F(CycloneServices, AnswerBothKindsOfClientsOnOneTopic) {
  CycloneProcess cyclone({"get_parameter", "/robot1/maps", "map_frame"});
  rcl_interfaces::srv::GetParameters_Request request;
  request.names({"map_frame"});
  const auto participant = make_participant();
  for (int i = 0; i < 20; ++i) {
    const auto response = bus::call_service<bus::srv::GetParameters>(
        participant, "/robot1/maps/get_parameters", request, std::chrono::seconds(20));
    ASSERT_TRUE(response.has_value());
    ASSERT_EQ(response->values().size(), 1U);
    EXPECT_EQ(response->values()[0].string_value(), "floor2");
  }
  EXPECT_EQ(cyclone.wait_for_line("value"), "value 4 'floor2' 0 0");
}

/// Clients come and go while the service stays.
TEST_F(CycloneServices, AnswerClientsThatComeAfterOthersHaveLeft) {
  for (int i = 0; i < 8; ++i) {
    CycloneProcess get({"get_parameter", "/robot1/maps", "map_frame"});
    ASSERT_EQ(get.wait_for_line("value"), "value 4 'floor2' 0 0") << "client " << i;
  }
}

}  // namespace
}  // namespace strata::test
