// SPDX-License-Identifier: Apache-2.0
#include "components/map_server/map_server.hpp"

#include <limits>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace strata::map_server
