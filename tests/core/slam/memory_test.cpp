// SPDX-License-Identifier: Apache-2.0
/// What SLAM holds while it works. A program of its own, since it replaces the global allocation
/// functions.
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/slam/ring_world.hpp"
#include "tests/support/counted_allocations.hpp"

namespace strata::slam {
namespace {

/// A log of halls: the ring four times as large, seen up to 60 m, scans a metre apart.
std::vector<Observation> record_halls() {
  constexpr double kScale = 4.0;
  std::vector<test::Wall> walls = test::ring();
  for (test::Wall& wall : walls) {
    wall = {kScale * wall.x0, kScale * wall.y0, kScale * wall.x1, kScale * wall.y1};
  }
  std::vector<Pose2> path = test::drive_round(1.0 / kScale, 90.0);
  for (Pose2& pose : path) pose = {kScale * pose.x, kScale * pose.y, pose.theta};
  std::vector<Observation> log = test::record(walls, path, 0, 11);
  for (std::size_t i = 0; i < path.size(); ++i) {
    log[i].scan = test::scan_of(walls, path[i], 0.2 * static_cast<double>(i), 0.01, 11, 180,
                                std::numbers::pi, 60.0);
  }
  return log;
}

TEST(MemoryOfSlam, OfLargeHallsIsNotThatOfAllTablesThatClosuresWereSearchedIn) {
  const std::vector<Observation> log = record_halls();
  Slam slam({}, 1);
  const std::size_t before_bytes = test::held_bytes;
  test::most_held_bytes = before_bytes;
  for (const Observation& observation : log) slam.add(observation);
  EXPECT_GT(slam.kept_local_maps(), 20U);
  EXPECT_LT(test::most_held_bytes - before_bytes, 70'000'000U);
}

}  // namespace
}  // namespace strata::slam
