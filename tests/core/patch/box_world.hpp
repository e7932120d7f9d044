// SPDX-License-Identifier: Apache-2.0
/// A plain corridor with a box that stands somewhere else at times, for tests of the patch room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/random/stream.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch::test_world {

/// With the box at one of five places against the walls; -1: none.
inline ToyWorld corridor_with_box(int place) {
  ToyWorld world;
  world.walls = {
      {0.0, 0.0, 12.0, 0.0}, {0.0, 0.0, 0.0, 2.4}, {12.0, 0.0, 12.0, 2.4}, {0.0, 2.4, 12.0, 2.4}};
  const double x[] = {4.5, 5.7, 6.9, 8.1, 3.3};
  const double y[] = {0.02, 1.88, 0.02, 1.88, 1.88};
  if (place >= 0) world.add_box(x[place], y[place], x[place] + 0.6, y[place] + 0.5);
  return world;
}

/// Drives along it, one for each place of the box, each with an error of pose of its own.
inline std::vector<PosedScan> drive_past_box(const std::vector<int>& places, std::uint64_t seed,
                                             Visits visits) {
  std::vector<PosedScan> scans;
  for (std::size_t v = 0; v < places.size(); ++v) {
    RandomStream random(seed, StreamId::kTest, v);
    const Pose2 error = random_error(0.01, 0.1 * 3.14159265358979323846 / 180.0, random);
    const bool is_one_run = visits == Visits::kOneRun;
    ToyRobot{}.drive(corridor_with_box(places[v]), {1.0, 1.2, 0.0}, {11.0, 1.2, 0.0},
                     is_one_run ? 0 : static_cast<int>(v),
                     is_one_run ? 100.0 * static_cast<double>(v) : 0.0, error, random, scans);
  }
  return scans;
}

}  // namespace strata::patch::test_world
