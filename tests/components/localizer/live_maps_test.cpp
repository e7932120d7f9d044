// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/live_maps.hpp"

#include <gtest/gtest.h>

#include "components/maps/node_map_message.hpp"
#include "tests/components/maps/learned_room.hpp"

namespace strata::localizer {
namespace {

// Otherwise the robot would go on learning in the folder's memory, decoded by the message's rules.
TEST(LiveMaps, KeepNoMemoryOfAFolderBesideANodeMapFromItsTopic) {
  maps::Maps folder = maps::test_room::make_maps();
  folder.decoding = memory::scene_decoding();
  LiveMaps maps("timescale", {});
  maps.begin_with(folder);
  EXPECT_FALSE(maps.has_news());
  maps.add(maps::to_message(*folder.timescale, *folder.timescale->decode(), Stamp(), "map"));
  ASSERT_TRUE(maps.has_news());
  const maps::Maps& known = maps.take();
  EXPECT_EQ(known.timescale, nullptr);
  ASSERT_NE(known.nodes, nullptr);
  EXPECT_EQ(known.nodes->nodes().size(), folder.timescale->nodes().size());
  EXPECT_GT(known.filtered.size(), 0U);
  EXPECT_FALSE(maps.has_news());
}

}  // namespace
}  // namespace strata::localizer
