// SPDX-License-Identifier: Apache-2.0
/// Where a robot is at its first scan after its process was stopped.
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"
#include "core/slam/slam.hpp"

namespace strata::slam {

/// Where a robot was when its process was stopped, in a map.
struct KeptPlace {
  Stamp stamp;  ///< of the newest scan that was kept
  std::optional<Pose2> odom_from_robot;
  Pose2 map_from_robot;
};

struct ResumedPlace {
  /// The odometry has gone on meanwhile, and says how far the robot has moved; else it began anew,
  /// and the robot is where it was.
  bool is_dead_reckoned = false;
  /// Where the scan fits best about there, if it fits.
  Pose2 map_from_robot;
  /// Share of the first scan's hits that are inliers of the map there.
  double inlier_share = 0.0;
  /// Whether that is enough to believe the place.
  [[nodiscard]] bool fits() const { return inlier_share >= 0.5; }
};

/// Whether odometry went on nobody says, so the scan is registered to the map at both places. Where
/// it fits both alike, odometry of a scan that is_recent has gone on, and later where it has
/// neither begun at zero again nor moved faster than a robot does. first: with odometry if kept has
/// some, or nothing is dead reckoned. O(cells of the map).
[[nodiscard]] ResumedPlace resumed_place(const KeptPlace& kept, const Observation& first,
                                         bool is_recent, const ReflectionGrid& map);

/// How a mapper goes on with its first scan after its process was stopped.
struct ResumedRun {
  int run = 0;        ///< of that scan
  bool fits = false;  ///< it looks as the map does where the robot is taken to be
};

/// Where the scan fits the map a new run begins there, also when odometry has gone on: what the map
/// says of the place is better than odometry over all that was missed, and of one long step a
/// tracker knows so little that it slides along corridors. Where it fits nowhere, the run goes on
/// by its odometry if that is recent; else the next run is looked for in the map as a whole. slam:
/// with a restored state, whose newest scan is placed. covariance: of the robot about the place.
[[nodiscard]] ResumedRun resume_run(Slam& slam, const Observation& first, bool is_recent,
                                    const beam_filter::BeamFilterConfig& filter,
                                    const Eigen::Matrix3d& covariance);

}  // namespace strata::slam
