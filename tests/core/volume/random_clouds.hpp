// SPDX-License-Identifier: Apache-2.0
/// Clouds of a room with a pillar, seen from random poses.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/random/stream.hpp"
#include "core/volume/cloud.hpp"

namespace strata::volume::test_clouds {

/// Range along a direction to the walls of a box of half edges (4, 3, 1.5) around the origin.
inline double range_to_walls(const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
  const Eigen::Vector3d half(4.0, 3.0, 1.5);
  double range = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (along[i] == 0.0) continue;
    range = std::min(range, ((along[i] > 0.0 ? half[i] : -half[i]) - from[i]) / along[i]);
  }
  return range;
}

inline Pose3 random_pose(RandomStream& random) {
  Pose3 pose;
  pose.translation = {random.uniform(-2.0, 2.0), random.uniform(-1.5, 1.5),
                      random.uniform(-0.5, 0.5)};
  const Eigen::Vector3d axis(random.normal(), random.normal(), random.normal());
  pose.rotation = Eigen::AngleAxisd(random.uniform(-3.0, 3.0), axis.normalized());
  return pose;
}

inline Cloud room_cloud(std::uint64_t seed, std::uint64_t step, std::size_t points) {
  RandomStream random(seed, StreamId::kTest, step);
  Cloud cloud;
  cloud.map_from_sensor = random_pose(random);
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3d along =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const double range = range_to_walls(cloud.map_from_sensor.translation, along);
    const Eigen::Vector3d end = cloud.map_from_sensor.translation + along * range;
    cloud.points_m.push_back((inverse(cloud.map_from_sensor) * end).cast<float>());
  }
  return cloud;
}

}  // namespace strata::volume::test_clouds
