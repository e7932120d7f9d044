// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/live_maps.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "components/convert/map_messages.hpp"
#include "components/maps/node_map_message.hpp"
#include "core/base/error.hpp"
#include "tests/components/maps/learned_room.hpp"
#include "tests/components/maps/toy_model.hpp"

namespace strata::localizer {
namespace {

// Otherwise the robot would go on learning in the folder's memory, decoded by the message's rules.
TEST(LiveMaps, KeepNoMemoryOfAFolderBesideANodeMapFromItsTopic) {
  maps::Maps folder = maps::test_room::make_maps();
  folder.decoding = memory::scene_decoding();
  LiveMaps maps(maps::map_models().at("timescale"), {});
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

TEST(LiveMaps, AskForTheTopicsOfWhatAModelIsMadeOfAndForTheFreeSpace) {
  using maps::MapPart;
  const auto needs = [](const char* model) {
    const LiveMaps maps(maps::test_room::with_toy().at(model), {});
    std::vector<MapPart> parts;
    for (const MapPart part : {MapPart::kOccupancy, MapPart::kFiltered, MapPart::kPatches,
                               MapPart::kPlacePatches, MapPart::kTimescale, MapPart::kGiven}) {
      if (maps.needs(part)) parts.push_back(part);
    }
    return parts;
  };
  EXPECT_EQ(needs("occupancy"), std::vector{MapPart::kOccupancy});
  EXPECT_EQ(needs("toy"), std::vector{MapPart::kOccupancy});
  EXPECT_EQ(needs("filtered"), std::vector{MapPart::kFiltered});
  EXPECT_EQ(needs("patch_shared"), (std::vector{MapPart::kFiltered, MapPart::kPatches}));
  EXPECT_EQ(needs("timescale_mid"), (std::vector{MapPart::kFiltered, MapPart::kTimescale}));
}

TEST(LiveMaps, OfAModelThatIsOnlyRegisteredComeWithTheGridThatItIsMadeOf) {
  LiveMaps maps(maps::test_room::with_toy().at("toy"), {});
  const ReflectionGrid grid(0.1, {{0, 0}, {9, 4}}, 0.1F);
  maps.add(convert::to_occupancy(grid, Stamp(), "map"));
  ASSERT_TRUE(maps.has_news());
  const maps::Maps& known = maps.take();
  EXPECT_EQ(known.occupancy.size(), grid.size());
  EXPECT_EQ(known.filtered.size(), grid.size());
}

TEST(LiveMaps, AreRefusedForAModelWhoseMapComesOverNoTopic) {
  for (const char* model : {"patch_places", "cells", "map"}) {
    EXPECT_THROW(LiveMaps(maps::map_models().at(model), {}), ConfigError) << model;
  }
}

}  // namespace
}  // namespace strata::localizer
