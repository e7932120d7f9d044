// SPDX-License-Identifier: Apache-2.0
/// A hall with a gate onto nothing, which only beams without return show as open.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/patch/patch_map.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch::test_world {

/// A hall of 10 m x 5 m without a wall in the north but for its ends, and the gate when closed.
inline ToyWorld hall_with_gate(bool is_closed) {
  ToyWorld world;
  world.walls = {{0.0, 0.0, 10.0, 0.0}, {0.0, 0.0, 0.0, 5.0},  {10.0, 0.0, 10.0, 5.0},
                 {0.0, 5.0, 3.5, 5.0},  {6.5, 5.0, 10.0, 5.0}, {4.0, 0.5, 5.0, 0.5}};
  if (is_closed) world.walls.push_back({3.5, 5.0, 6.5, 5.0});
  return world;
}

/// Past the gate once a minute.
inline std::vector<PosedScan> drive_past_gate(const std::vector<bool>& closed,
                                              Visits visits = Visits::kRuns) {
  std::vector<PosedScan> scans;
  RandomStream random(4, StreamId::kTest, 5);
  const ToyRobot robot;
  for (std::size_t v = 0; v < closed.size(); ++v) {
    const Pose2 error{0.01 * random.normal(), 0.01 * random.normal(), 0.002 * random.normal()};
    const bool is_back = v % 2 == 1;
    const Pose2 a{1.5, 2.5, is_back ? 3.14159265 : 0.0};
    const Pose2 b{8.5, 2.5, a.theta};
    robot.drive(hall_with_gate(closed[v]), is_back ? b : a, is_back ? a : b,
                visits == Visits::kOneRun ? 0 : static_cast<int>(v), 60.0 * static_cast<double>(v),
                error, random, scans);
  }
  return scans;
}

/// Areas whose configurations are the closed gate and the open one.
inline int gates_of(const PatchMap& map) {
  const Cell middle = cell_at({5.0, 5.0}, map.base.resolution_m());
  int count = 0;
  for (const Submap& submap : map.submaps) {
    int closed = 0;
    int open = 0;
    for (const Configuration& configuration : submap.configurations) {
      float most = 0.0F;
      for (int y = -2; y <= 2; ++y) {
        const float m = configuration.reflection.get({middle.x, middle.y + y});
        if (is_known(m)) most = std::max(most, m);
      }
      ++(most > 0.5F ? closed : open);
    }
    if (closed == 1 && open == 1) ++count;
  }
  return count;
}

inline const std::vector<bool> kGateOfEightDays{true, false, false, true, false, true, true, false};

}  // namespace strata::patch::test_world
