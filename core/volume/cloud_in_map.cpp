// SPDX-License-Identifier: Apache-2.0
#include "core/volume/cloud_in_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <octomap/octomap_types.h>

#include "core/base/error.hpp"

namespace strata::volume {
namespace {

octomath::Pose6D octomap_pose(const Pose3& pose) {
  const auto& t = pose.translation;
  const auto& q = pose.rotation;
  return {octomath::Vector3(static_cast<float>(t.x()), static_cast<float>(t.y()),
                            static_cast<float>(t.z())),
          octomath::Quaternion(static_cast<float>(q.w()), static_cast<float>(q.x()),
                               static_cast<float>(q.y()), static_cast<float>(q.z()))};
}

Eigen::Vector3f eigen_vector(const octomath::Vector3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

RayLimits ray_limits(const VolumeConfig& config) {
  RayLimits limits;
  limits.max_range_m = config.max_range_m;
  if (config.box_m.empty()) return limits;
  const auto key = [&](std::size_t i) {
    const double place = std::floor(config.box_m[i] / config.resolution_m);
    return static_cast<std::int32_t>(
        std::clamp(place + kLatticeMiddle, 0.0, 2.0 * kLatticeMiddle - 1.0));
  };
  limits.box = {{key(0), key(1), key(2)}, {key(3), key(4), key(5)}};
  return limits;
}

void bring_into_map(const Cloud& cloud, WorkerPool& pool, CloudInMap& in_map) {
  const std::vector<CloudPart> parts = parts_of(cloud);
  in_map.origins.clear();
  in_map.ends_m.resize(cloud.points_m.size());
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const Pose3& given = parts[part].map_from_sensor;
    if (!given.translation.allFinite() || !given.rotation.coeffs().allFinite()) {
      throw InputError("cloud at " + std::to_string(cloud.stamp.seconds()) + " s",
                       "its pose is not finite", "give a pose, or leave the cloud out");
    }
    const octomath::Pose6D pose = octomap_pose(given);
    const std::size_t first = parts[part].begin;
    pool.for_chunks(end_of_part(cloud, parts, part) - first, 4096,
                    [&](std::size_t begin, std::size_t end, std::size_t) {
                      for (std::size_t i = first + begin; i < first + end; ++i) {
                        const Eigen::Vector3f& p = cloud.points_m[i];
                        in_map.ends_m[i] =
                            eigen_vector(pose.transform(octomath::Vector3(p.x(), p.y(), p.z())));
                      }
                    });
    // There and back through the pose, rounding as OctoMap rounds a scan node's origin.
    in_map.origins.push_back(
        {first, eigen_vector(pose.transform(pose.inv().transform(pose.trans())))});
  }
}

}  // namespace strata::volume
