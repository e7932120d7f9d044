// SPDX-License-Identifier: Apache-2.0
#include "core/scan/cloud_slice.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace strata {

CloudSlice slice_cloud(std::span<const Eigen::Vector3f> points_m, std::span<const float> offset_s,
                       Stamp stamp, const Pose3& robot_from_sensor,
                       const CloudSliceConfig& config) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  // An even number, so that one looks straight ahead.
  const std::size_t beams =
      2 * static_cast<std::size_t>(std::ceil(0.5 * kTurn / config.angle_increment_rad));
  CloudSlice slice;
  Scan& scan = slice.scan;
  scan.stamp = stamp;
  scan.angle_min_rad = static_cast<float>(-std::numbers::pi);
  scan.angle_increment_rad = static_cast<float>(kTurn / static_cast<double>(beams));
  scan.range_min_m = static_cast<float>(config.min_range_m);
  scan.range_max_m = static_cast<float>(config.max_range_m);
  scan.ranges_m.assign(beams, std::numeric_limits<float>::quiet_NaN());
  scan.robot_from_laser = planar(robot_from_sensor);
  if (!offset_s.empty()) slice.offset_s.assign(beams, 0.0F);

  const Eigen::Matrix3d rotation = robot_from_sensor.rotation.toRotationMatrix();
  const double heading = scan.robot_from_laser.theta;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d arm = rotation * points_m[i].cast<double>();  // in the robot's axes
    const double height_m = arm.z() + robot_from_sensor.translation.z();
    const double range_m = std::hypot(arm.x(), arm.y());
    const bool counts = height_m >= config.min_height_m && height_m <= config.max_height_m &&
                        range_m >= config.min_range_m && range_m < config.max_range_m;
    if (!counts) continue;  // NaN too
    const double bearing = std::atan2(arm.y(), arm.x()) - heading + std::numbers::pi;
    const double turns = bearing / kTurn;
    const double share = turns - std::floor(turns);
    const auto beam =
        static_cast<std::size_t>(std::lround(share * static_cast<double>(beams))) % beams;
    float& nearest = scan.ranges_m[beam];
    const auto range = static_cast<float>(range_m);
    if (nearest <= range) continue;  // false while it is NaN
    nearest = range;
    if (!offset_s.empty()) slice.offset_s[beam] = offset_s[i];
  }
  return slice;
}

}  // namespace strata
