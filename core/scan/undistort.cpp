// SPDX-License-Identifier: Apache-2.0
#include "core/scan/undistort.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "core/geometry/angle.hpp"

namespace strata {
namespace {

/// The same transform with its sine and cosine worked out once.
Eigen::Isometry2d isometry(const Pose2& a_from_b) {
  return Eigen::Translation2d(a_from_b.translation()) * Eigen::Rotation2Dd(a_from_b.theta);
}

}  // namespace

Duration sweep_duration(const Scan& scan) {
  const double beams = scan.size() > 0 ? static_cast<double>(scan.size() - 1) : 0.0;
  const double sweep_s = static_cast<double>(scan.time_increment_s) * beams;
  return std::abs(sweep_s) < kLongestSweepS ? Duration::from_seconds(sweep_s) : Duration{};
}

namespace {

/// taken: when each beam was, as a share of the motion.
template <typename Taken>
Scan corrected_by(const Scan& scan, const Pose2& start_from_end, const Taken& taken) {
  Scan corrected = scan;
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) == BeamKind::kHit) corrected.ranges_m[beam] = nothing;
  }
  const Eigen::Isometry2d robot_from_laser = isometry(scan.robot_from_laser);
  const Eigen::Isometry2d laser_from_robot = isometry(inverse(scan.robot_from_laser));
  const double increment = static_cast<double>(scan.angle_increment_rad);
  const auto last = static_cast<double>(scan.size() - 1);
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) != BeamKind::kHit) continue;
    const Pose2 start_from_robot = interpolate(Pose2{}, start_from_end, taken(beam));
    const double range_m = static_cast<double>(scan.ranges_m[beam]);
    const double bearing = scan.bearing_rad(beam);
    const Eigen::Vector2d seen(range_m * std::cos(bearing), range_m * std::sin(bearing));
    const Eigen::Vector2d in_robot = robot_from_laser * seen;
    const Eigen::Vector2d in_start = start_from_robot * in_robot;
    const Eigen::Vector2d point = laser_from_robot * in_start;
    // Unwrap next to the original bearing, so that a full turn does not fold onto itself.
    const double moved = bearing + angle_difference(std::atan2(point.y(), point.x()), bearing);
    const double index = std::round((moved - static_cast<double>(scan.angle_min_rad)) / increment);
    if (!(index >= 0.0 && index <= last)) continue;  // nor NaN
    float& slot = corrected.ranges_m[static_cast<std::size_t>(index)];
    const auto range = static_cast<float>(point.norm());
    if (!(slot <= range)) slot = range;
  }
  return corrected;
}

}  // namespace

Scan undistort(const Scan& scan, const Pose2& start_from_end, bool reversed) {
  if (scan.time_increment_s == 0.0F || scan.size() < 2 || scan.angle_increment_rad == 0.0F) {
    return scan;
  }
  const auto last = static_cast<double>(scan.size() - 1);
  return corrected_by(scan, start_from_end, [&](std::size_t beam) {
    return static_cast<double>(reversed ? scan.size() - 1 - beam : beam) / last;
  });
}

Scan undistort(const Scan& scan, std::span<const float> offset_s, const Pose2& start_from_end,
               double sweep_s) {
  if (scan.size() < 2 || scan.angle_increment_rad == 0.0F || sweep_s == 0.0) return scan;
  return corrected_by(scan, start_from_end, [&](std::size_t beam) {
    return static_cast<double>(offset_s[beam]) / sweep_s;
  });
}

}  // namespace strata
