// SPDX-License-Identifier: Apache-2.0
/// Whether a robot can be where it is taken to be: how a single scan lies on a map.
#pragma once

#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"
#include "core/slam/local_map_agreement.hpp"

namespace strata::slam {

struct ScanFit {
  Pose2 map_from_robot;  ///< of the poses tried the one with most inliers
  Agreement agreement;   ///< of the scan's hits with the map, from there
  /// Share of the hits that end on a surface of the map.
  [[nodiscard]] double inlier_share() const { return agreement.overlap * agreement.agreement; }
};

/// How far about a pose to look.
struct FitReach {
  double reach_m = 0.5;
  double step_m = 0.1;
  double reach_rad = 0.15;
  double step_rad = 0.025;
};

/// Deterministic. A scan without hits has no inliers. O(poses tried x hits, of which at most 200
/// are looked at).
[[nodiscard]] ScanFit fit_near(const ReflectionGrid& map, const Scan& scan,
                               const Pose2& map_from_robot, const FitReach& reach = {});

}  // namespace strata::slam
