// SPDX-License-Identifier: Apache-2.0
#include "components/map_server/map_server.hpp"

#include <chrono>
#include <fstream>

#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/log/map_file.hpp"
#include "components/map_server/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::map_server {
namespace {

using nav_msgs::msg::OccupancyGrid;

Stamp machine_time() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count()};
}

/// As served: the file's map with the stamps that `served` has.
OccupancyGrid map_of(const std::filesystem::path& file, const std::string& frame,
                     const OccupancyGrid& served) {
  return convert::to_occupancy(log::read_map(file), convert::from_message(served.header().stamp()),
                               frame);
}

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
  const Stamp before = machine_time();
  const auto host = test::make_host("{type: strata::MapServer, name: maps, parameters: {map: '" +
                                        file.string() + "', map_frame: floor2}}",
                                    registry, test::make_participant());
  host->activate();
  // Another participant, made after the map went out.
  test::Collector<OccupancyGrid> late(test::make_participant(), "/map", "latched");
  const auto maps = late.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0], map_of(file, "floor2", maps[0]));
  const Stamp loaded = convert::from_message(maps[0].info().map_load_time());
  EXPECT_EQ(convert::from_message(maps[0].header().stamp()), loaded);
  EXPECT_GE(loaded, before);
  EXPECT_LE(loaded, machine_time());
  EXPECT_EQ(maps[0].info().width(), 7U);
  EXPECT_EQ(maps[0].info().height(), 4U);
  EXPECT_EQ(maps[0].data()[0], 100);
}

// As nav2's does where a floor's map is named when the robot has come there.
TEST(MapServer, WithoutAMapWaitsForOneToBeNamed) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "room.yaml";
  ReflectionGrid grid = make_reflection_grid(0.1, CellRect{{0, 0}, {4, 6}});
  grid.at({0, 0}) = 1.0F;
  log::write_map(file, grid);
  runtime::Registry registry;
  register_component(registry);
  const auto host = test::make_host("{type: strata::MapServer, name: map_server}", registry,
                                    test::make_participant());
  host->activate();
  const auto client = test::make_participant();
  const auto none =
      bus::call_service<bus::srv::GetMap>(client, "/map_server/map", {}, std::chrono::seconds(20));
  ASSERT_TRUE(none.has_value());
  EXPECT_TRUE(none->grid().data().empty());
  nav2_msgs::srv::LoadMap_Request request;
  request.map_url(file.string());
  const auto loaded = bus::call_service<bus::srv::LoadMap>(client, "/map_server/load_map", request,
                                                           std::chrono::seconds(20));
  ASSERT_TRUE(loaded.has_value());
  EXPECT_EQ(loaded->result(), 0);
  test::Collector<OccupancyGrid> late(client, "/map", "latched");
  const auto maps = late.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0], loaded->grid());
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
  const auto before = served();
  ASSERT_TRUE(before.has_value());
  const OccupancyGrid first = before->grid();
  EXPECT_EQ(first, map_of(file, "map", first));
  const auto loaded = load("file://" + other.string());
  EXPECT_EQ(loaded.result(), 0);
  const OccupancyGrid second = map_of(other, "map", loaded.grid());
  EXPECT_GT(convert::from_message(second.header().stamp()),
            convert::from_message(first.header().stamp()));
  EXPECT_EQ(loaded.grid(), second);
  EXPECT_EQ(served()->grid(), second);
  test::Collector<OccupancyGrid> late(test::make_participant(), "/map", "latched");
  const auto maps = late.wait_for(1);
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0], second);
}

}  // namespace
}  // namespace strata::map_server
