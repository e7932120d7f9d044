// SPDX-License-Identifier: Apache-2.0
/// A piece of a run whose inner shape is trusted: loop closures move it as one.
#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/registration/match_field.hpp"
#include "core/tracking/surface_map.hpp"

namespace strata::slam {

/// What is known about a place of a local map, cell by cell.
using StateGrid = Grid<SurfaceState>;

/// A finished local map. `points` and `states` are in the local map's own frame, whose origin is
/// the robot's pose when the local map took over.
struct LocalMap {
  int run = 0;
  std::size_t first_scan = 0;  ///< index of the first scan that belongs to it
  std::size_t last_scan = 0;   ///< ... and one past the last
  Pose2 run_from_local_map;    ///< in the drifting frame of its run
  /// How uncertain its pose is seen from the local map before it in the run (frame of that one).
  Eigen::Matrix3d from_previous = Eigen::Matrix3d::Zero();
  std::vector<registration::SurfacePoint> points;
  StateGrid states;
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();  ///< mean of the points

  /// Whether it can be of a log of so many scans.
  [[nodiscard]] bool is_of(std::size_t scans) const {
    return first_scan <= last_scan && last_scan <= scans;
  }

  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.run);
    archive(self.first_scan);
    archive(self.last_scan);
    archive(self.run_from_local_map);
    archive(self.from_previous);
    archive(self.points);
    archive(self.states);
    archive(self.center_m);
  }
};

/// Freezes a surface map (in the run's frame) into a local map.
[[nodiscard]] LocalMap make_local_map(const SurfaceMap& map, int run,
                                      const Pose2& run_from_local_map, std::size_t first_scan,
                                      std::size_t last_scan);

}  // namespace strata::slam
