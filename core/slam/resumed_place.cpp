// SPDX-License-Identifier: Apache-2.0
#include "core/slam/resumed_place.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/slam/live_map.hpp"
#include "core/slam/scan_fit.hpp"

namespace strata::slam {
namespace {

/// By so much the better place must have more inliers than the other.
constexpr double kClearly = 0.15;

bool is_near_zero(const Pose2& pose) {
  return std::hypot(pose.x, pose.y) < 0.1 && std::abs(pose.theta) < 0.05;
}

bool may_have_gone_on(const Pose2& before, const Pose2& now, double seconds) {
  constexpr double kFastest_mps = 2.0;
  constexpr double kSlack_m = 0.5;
  if (is_near_zero(now) && !is_near_zero(before)) return false;
  return seconds >= 0.0 && translation_distance(before, now) <= kSlack_m + kFastest_mps * seconds;
}

/// Odometry drifts.
FitReach reach_after(double moved_m) {
  FitReach reach;
  reach.reach_m = std::min(1.5, reach.reach_m + 0.1 * moved_m);
  reach.reach_rad = std::min(0.4, reach.reach_rad + 0.03 * moved_m);
  return reach;
}

}  // namespace

ResumedPlace resumed_place(const KeptPlace& kept, const Observation& first, bool is_recent,
                           const ReflectionGrid& map) {
  const ScanFit stayed = fit_near(map, first.scan, kept.map_from_robot);
  ResumedPlace where_it_was{false, stayed.map_from_robot, stayed.inlier_share()};
  if (!where_it_was.fits()) where_it_was.map_from_robot = kept.map_from_robot;
  if (!kept.odom_from_robot || !first.has_odometry) return where_it_was;
  const Pose2 step = between(*kept.odom_from_robot, first.odom_from_robot);
  const ScanFit dead_reckoned =
      fit_near(map, first.scan, kept.map_from_robot * step, reach_after(step.translation().norm()));
  const double since_s = (first.scan.stamp - kept.stamp).seconds();
  const bool seems_continuous =
      is_recent || may_have_gone_on(*kept.odom_from_robot, first.odom_from_robot, since_s);
  const double ahead = dead_reckoned.inlier_share() - stayed.inlier_share();
  if (seems_continuous ? ahead < -kClearly : ahead <= kClearly) return where_it_was;
  return {true, dead_reckoned.map_from_robot, dead_reckoned.inlier_share()};
}

ResumedRun resume_run(Slam& slam, const Observation& first, bool is_recent,
                      const beam_filter::BeamFilterConfig& filter,
                      const Eigen::Matrix3d& covariance) {
  const Slam::Newest kept = *slam.newest();
  LiveMap map(filter);
  (void)map.update(slam, std::numeric_limits<std::size_t>::max());
  const ResumedPlace place = resumed_place({kept.stamp, kept.odom_from_robot, kept.map_from_robot},
                                           first, is_recent, map.filtered());
  const bool goes_on = is_recent && place.is_dead_reckoned && !place.fits();
  if (place.fits()) slam.begin_next_run_at({place.map_from_robot, covariance});
  return {goes_on ? kept.run : kept.run + 1, place.fits()};
}

}  // namespace strata::slam
