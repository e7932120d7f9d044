// SPDX-License-Identifier: Apache-2.0
/// One beam a scan from the origin along x: to a wall at 4 m, or to a door leaf at 2 m.
#pragma once

#include "core/cells/cell_learner.hpp"

namespace strata::cells::test_corridor {

inline constexpr double kDoor_m = 2.02;  ///< in the middle of a cell of 0.04 m
inline constexpr double kWall_m = 4.02;
inline constexpr double kResolution_m = 0.04;
inline const Eigen::Vector2d kDoor{kDoor_m, 0.02};
inline const Eigen::Vector2d kWall{kWall_m, 0.02};
inline const Eigen::Vector2d kFree{1.02, 0.02};
inline const Pose2 kPose{0.02, 0.02, 0.0};

inline PosedScan look(double time_s, bool is_closed, int run = 0) {
  PosedScan posed;
  posed.run = run;
  posed.map_from_robot = kPose;
  posed.scan.stamp = Stamp::from_seconds(time_s);
  posed.scan.range_max_m = 30.0F;
  posed.scan.angle_increment_rad = 0.1F;
  posed.scan.ranges_m = {static_cast<float>((is_closed ? kDoor_m : kWall_m) - kPose.x)};
  return posed;
}

/// Four scans within half a second: enough to decide.
inline void visit(CellLearner& learner, double time_s, bool is_closed, int run = 0) {
  for (int i = 0; i < 4; ++i) learner.add(look(time_s + 0.1 * i, is_closed, run));
}

inline const CellState& state_at(const CellMap& map, const Eigen::Vector2d& point_m) {
  return map.cells.get(cell_at(point_m, map.cells.resolution_m()));
}

inline CellMap learned(CellLearner& learner, int threads = 1) {
  WorkerPool pool(threads);
  return learner.finish(pool);
}

}  // namespace strata::cells::test_corridor
