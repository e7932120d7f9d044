// SPDX-License-Identifier: Apache-2.0
/// What scans from known poses leave of a world: its map, and where in the cells its surfaces lie.
#pragma once

#include <cstddef>
#include <vector>

#include "core/grid/counting_map.hpp"
#include "core/slam/learned_surfaces.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::test {

struct SurveyedWorld {
  ReflectionGrid map;
  SurfaceLayer surfaces;
};

inline std::vector<PosedScan> scans_at(const BoxWorld& world, const std::vector<Pose2>& poses,
                                       std::uint64_t seed, double noise_m = 0.01) {
  RandomStream random(seed, StreamId::kTest);
  std::vector<PosedScan> scans;
  for (const Pose2& pose : poses) {
    scans.push_back({0, make_scan(world, pose, 12.0, 360, noise_m, random, 0.1), pose, {}});
  }
  return scans;
}

inline SurveyedWorld survey(const std::vector<PosedScan>& scans, double resolution_m = 0.05) {
  CountingMap counts(resolution_m);
  for (const PosedScan& posed : scans) counts.add(posed);
  return {counts.reflection(), slam::learned_surfaces(scans, resolution_m)};
}

/// On a lattice, looking in all directions.
inline std::vector<Pose2> places(double x0, double y0, double x1, double y1, double step) {
  std::vector<Pose2> poses;
  for (double x = x0; x <= x1; x += step) {
    for (double y = y0; y <= y1; y += step) {
      poses.push_back({x, y, static_cast<double>(poses.size())});
    }
  }
  return poses;
}

/// A room of 8 m x 6 m whose walls lie nowhere on the edges of cells.
inline BoxWorld crooked_room() {
  return {{-0.3, -0.3, 8.513, 0.017}, {-0.3, 6.031, 8.513, 6.4}, {-0.3, -0.3, 0.023, 6.4},
          {8.013, -0.3, 8.5, 6.4},    {2.0, 0.0, 2.641, 1.009},  {5.0, 5.2, 5.837, 6.2}};
}

}  // namespace strata::test
