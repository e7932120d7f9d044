// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/stored_places.hpp"

#include <gtest/gtest.h>

#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

/// The k-th scan of a drive through the room, in a map whose origin lies at room_from_map.
PosedScan scan_on_a_drive(int k, const Pose2& room_from_map) {
  const Pose2 room_from_robot{-3.0 + 0.3 * (k % 24), 0.4 + 0.1 * (k % 5), 0.3 * k};
  PosedScan scan = observe(room_from_robot, 2000.0 + k, false);
  scan.map_from_robot = inverse(room_from_map) * room_from_robot;
  return scan;
}

TimescaleMemory of_the_drive() {
  TimescaleMemory memory({}, 1);
  for (int k = 0; k < 96; ++k) memory.observe(scan_on_a_drive(k, {}));
  return memory;
}

double share(const FrameLook& look) {
  return static_cast<double>(look.agreed) / static_cast<double>(look.judged);
}

TEST(StoredPlaces, AgreeWithScansInTheirOwnFrameOnly) {
  const TimescaleMemory memory = of_the_drive();
  StoredPlaces stored(memory.nodes().size());
  for (int k = 1; k < 24; k += 4) {
    const FrameLook own = stored.agreement(memory, {}, scan_on_a_drive(k, {}));
    EXPECT_GE(own.judged, 300U);
    EXPECT_GT(share(own), 0.9);
    for (const Pose2& frame : {Pose2{0.0, 0.0, 0.8}, Pose2{0.7, 0.9, 0.4}}) {
      const FrameLook other = stored.agreement(memory, {}, scan_on_a_drive(k, frame));
      EXPECT_TRUE(other.judged == 0 || share(other) < 0.3) << k << ": " << share(other);
    }
  }
}

TEST(StoredPlaces, KnowNothingOfWhatWasLearnedSince) {
  TimescaleMemory memory({}, 1);
  const Pose2 elsewhere{20.0, 0.0, 0.0};
  StoredPlaces stored(memory.nodes().size());
  for (int k = 0; k < 24; ++k) {
    EXPECT_EQ(stored.agreement(memory, {}, scan_on_a_drive(k, elsewhere)).judged, 0U);
    memory.observe(scan_on_a_drive(k, elsewhere));
  }
  // Nor do nodes that were there, but learn since they were looked at.
  memory = of_the_drive();
  StoredPlaces before(memory.nodes().size());
  const Pose2 other{0.0, 0.0, 0.8};
  const FrameLook first = before.agreement(memory, {}, scan_on_a_drive(4, other));
  for (int i = 0; i < 2000; ++i) {
    PosedScan scan = scan_on_a_drive(4, other);
    scan.scan.stamp = scan.scan.stamp + Duration::from_seconds(2.0 * i);
    memory.observe(scan);
  }
  EXPECT_EQ(before.agreement(memory, {}, scan_on_a_drive(4, other)).agreed, first.agreed);
}

TEST(StoredPlaces, LeaveOutBeamsThatHitWhatMoves) {
  const TimescaleMemory memory = of_the_drive();
  StoredPlaces stored(memory.nodes().size());
  PosedScan scan = scan_on_a_drive(5, {});
  const std::size_t all = stored.agreement(memory, {}, scan).judged;
  scan.static_probability.assign(scan.scan.size(), 1.0F);
  for (std::size_t i = 0; i < 100; ++i) scan.static_probability[i] = 0.1F;
  EXPECT_EQ(stored.agreement(memory, {}, scan).judged, all - 100);
}

}  // namespace
}  // namespace strata::memory
