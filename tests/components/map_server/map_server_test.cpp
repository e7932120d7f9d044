// SPDX-License-Identifier: Apache-2.0
#include "components/map_server/map_server.hpp"

#include <chrono>
#include <fstream>

#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/convert/map_messages.hpp"
#include "components/log/map_file.hpp"
#include "components/map_server/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::map_server {
namespace {

using nav_msgs::msg::OccupancyGrid;

TEST(MapServer, GivesAReaderThatComesLateTheMapOfTheFile) {
  const test::TemporaryDirectory folder;
  ReflectionGrid grid = make_reflection_grid(0.1, CellRect{{-3, 2}, {4, 6}});
  grid.at({-3, 2}) = 1.0F;
  grid.at({3, 5}) = 0.0F;
  grid.at({0, 3}) = 1.0F;
  const auto file = folder.path() / "room.yaml";
  log::write_map(file, grid);

  runtime::Registry registry;
  register_component(registry);
  const auto host = test::make_host("{type: strata::MapServer, name: maps, parameters: {map: '" +
                                        file.string() + "', map_frame: floor2}}",
                                    registry, test::make_participant());
  host->activate();
  // Another participant, made after the map went out.
  test::Collector<OccupancyGrid> late(test::make_participant(), "/map", "latched");
  const auto maps = late.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0], convert::to_occupancy(log::read_map(file), Stamp(), "floor2"));
  EXPECT_EQ(maps[0].info().width(), 7U);
  EXPECT_EQ(maps[0].info().height(), 4U);
  EXPECT_EQ(maps[0].data()[0], 100);
}

TEST(MapServer, LoadsAnotherMapOnRequestAndKeepsItsOwnWhenThatFails) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "first.yaml";
  const auto other = folder.path() / "second.yaml";
  ReflectionGrid grid = make_reflection_grid(0.1, CellRect{{0, 0}, {4, 6}});
  grid.at({0, 0}) = 1.0F;
  grid.at({3, 5}) = 0.0F;
  log::write_map(file, grid);
  grid.at({2, 2}) = 1.0F;
  log::write_map(other, grid);
  std::ofstream(folder.path() / "broken.yaml") << "image: none.pgm\n";

  runtime::Registry registry;
  register_component(registry);
  const auto host = test::make_host(
      "{type: strata::MapServer, name: map_server, parameters: {map: '" + file.string() + "'}}",
      registry, test::make_participant());
  const auto client = test::make_participant();
  const auto load = [&](const std::string& url) {
    nav2_msgs::srv::LoadMap_Request request;
    request.map_url(url);
    const auto response = bus::call_service<bus::srv::LoadMap>(client, "/map_server/load_map",
                                                               request, std::chrono::seconds(20));
    EXPECT_TRUE(response.has_value()) << url;
    return response.value_or(nav2_msgs::srv::LoadMap_Response());
  };
  const auto served = [&] {
    return bus::call_service<bus::srv::GetMap>(client, "/map_server/map", {},
                                               std::chrono::seconds(20));
  };
  EXPECT_EQ(load(other.string()).result(), 255) << "while inactive";
  host->activate();
  EXPECT_EQ(load((folder.path() / "absent.yaml").string()).result(), 1);
  EXPECT_EQ(load((folder.path() / "broken.yaml").string()).result(), 2);
  const auto errors = host->take_errors();
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NE(errors[0].find("broken.yaml"), std::string::npos) << errors[0];
  const auto first = convert::to_occupancy(log::read_map(file), Stamp(), "map");
  const auto second = convert::to_occupancy(log::read_map(other), Stamp(), "map");
  ASSERT_TRUE(served().has_value());
  EXPECT_EQ(served()->grid(), first);
  const auto loaded = load("file://" + other.string());
  EXPECT_EQ(loaded.result(), 0);
  EXPECT_EQ(loaded.grid(), second);
  EXPECT_EQ(served()->grid(), second);
  test::Collector<OccupancyGrid> late(test::make_participant(), "/map", "latched");
  const auto maps = late.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0], second);
}

}  // namespace
}  // namespace strata::map_server
