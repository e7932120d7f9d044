// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/changed_places.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "memory/nodes/timescale_memory.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

/// 400 scans around the origin, the box (x = 2 to 3, y = -1 to 1) in some of them.
std::shared_ptr<const NodeMap> room(bool box_at_first, bool box_at_last) {
  TimescaleMemory memory({}, 1);
  for (int t = 0; t < 400; ++t) {
    const Pose2 pose{0.3 * std::sin(0.7 * t), 0.3 * std::cos(0.7 * t), 0.1 * t};
    memory.observe(observe(pose, t, t < 385 ? box_at_first : box_at_last));
  }
  return memory.decode();
}

TEST(ChangedPlaces, AreFoundWhereABoxAppearedOrVanished) {
  for (const bool appeared : {true, false}) {
    const auto map = room(!appeared, appeared);
    const auto places = changed_places(*map, map->level_index("long"), map->level_index("short"));
    ASSERT_FALSE(places.empty());
    // The side that the node sees: x = 2, y = -1 to 1.
    EXPECT_EQ(places[0].kind, appeared ? ChangeKind::kAppeared : ChangeKind::kVanished);
    EXPECT_NEAR(places[0].center_m().x(), 2.0, 0.25);
    EXPECT_NEAR(places[0].center_m().y(), 0.0, 0.25);
    EXPECT_NEAR(places[0].max_m.y() - places[0].min_m.y(), 2.0, 0.4);
    for (const ChangedPlace& place : places) EXPECT_EQ(place.kind, places[0].kind);
  }
}

TEST(ChangedPlaces, AreNoneWhereNothingHasChanged) {
  for (const bool box : {false, true}) {
    const auto map = room(box, box);
    EXPECT_TRUE(changed_places(*map, 2, 0).empty());
    EXPECT_TRUE(changed_places(*map, 0, 0).empty());
  }
}

TEST(ChangedPlaces, AreNoneOfAnEmptyMemory) {
  EXPECT_TRUE(changed_places(*TimescaleMemory().decode(), 2, 0).empty());
}

}  // namespace
}  // namespace strata::memory
