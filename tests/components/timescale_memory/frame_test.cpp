// SPDX-License-Identifier: Apache-2.0
/// Memories that were kept in the frame of another map.
#include <cstddef>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/timescale_memory/live_memory.hpp"

namespace strata::timescale_memory {
namespace {

/// The k-th scan of a drive through the room, at 1 Hz; what it says of where: in a frame whose
/// origin lies at `origin`.
PosedScan scan_on_a_drive(int k, const Pose2& room_from_map) {
  PosedScan scan =
      observe({-3.0 + 0.3 * (k % 24), 0.4 + 0.1 * (k % 5), 0.3 * k}, 2000.0 + k, false);
  scan.map_from_robot = inverse(room_from_map) * scan.map_from_robot;
  return scan;
}

class LiveMemoryInAFrame : public LiveMemoryTest {
 protected:
  void keep_a_memory() const {
    TimescaleMemory memory({}, 1);
    for (int k = 0; k < 96; ++k) memory.observe(scan_on_a_drive(k, {}));
    memory::Store(path()).save_timescale(memory);
  }
  [[nodiscard]] bool is_set_aside() const { return std::filesystem::exists(path() + ".damaged"); }
};

TEST_F(LiveMemoryInAFrame, SetsAsideWhatWasLearnedInAnother) {
  keep_a_memory();
  const std::vector<std::byte> before = stored().state();
  const Pose2 room_from_map{0.7, 0.9, 0.4};  // a scan matcher that begins anew
  {
    LiveMemory memory("store: '" + path() + "'");
    Robot robot("/labeled_scan");
    for (int k = 0; k < 48; ++k) robot.publish(scan_on_a_drive(k, room_from_map));
    ASSERT_TRUE(memory.has_received("/labeled_scan", 48));
    const auto status = memory.status("nodes damaged", "0");
    EXPECT_THAT(status.message(), testing::HasSubstr("set aside as '" + path() + ".damaged'"));
  }
  ASSERT_TRUE(is_set_aside());
  EXPECT_EQ(memory::Store(path() + ".damaged").load_timescale().state(), before);
  // What came since then is kept in the new frame.
  EXPECT_GT(stored().observations(), 20U);
  LiveMemory again("store: '" + path() + "'");
  Robot robot("/labeled_scan");
  for (int k = 48; k < 72; ++k) robot.publish(scan_on_a_drive(k, room_from_map));
  ASSERT_TRUE(again.has_received("/labeled_scan", 24));
  EXPECT_FALSE(std::filesystem::exists(path() + ".damaged-2"));
}

TEST_F(LiveMemoryInAFrame, GoesOnInItsOwnThoughHalfOfTheRoomWasRefurnished) {
  keep_a_memory();
  LiveMemory memory("store: '" + path() + "'");
  Robot robot("/labeled_scan");
  for (int k = 0; k < 48; ++k) {
    PosedScan scan = scan_on_a_drive(k, {});
    for (std::size_t i = 0; i < scan.scan.size() / 2; ++i) scan.scan.ranges_m[i] *= 0.6F;
    robot.publish(scan);
  }
  ASSERT_TRUE(memory.has_received("/labeled_scan", 48));
  EXPECT_FALSE(is_set_aside());
}

}  // namespace
}  // namespace strata::timescale_memory
