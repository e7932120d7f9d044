// SPDX-License-Identifier: Apache-2.0
/// A room that the robot goes round in for twelve minutes; in the last two a box stands in the
/// middle of its right half (x = 2 to 3 m, y = -1 to 1 m).
#pragma once

#include <cmath>

#include "memory/nodes/timescale_memory.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::test {

inline memory::TimescaleMemory changed_room() {
  memory::TimescaleMemory memory({}, 1);
  for (int t = 0; t < 740; ++t) {
    const double angle = 0.1 * t;
    const Pose2 pose{1.2 + 2.9 * std::cos(angle), 2.0 * std::sin(angle), angle};
    memory.observe(memory::test_world::observe(pose, t, t >= 600));
  }
  return memory;
}

}  // namespace strata::test
