// SPDX-License-Identifier: Apache-2.0
/// Clouds where they lie in the map, as every map of voxels enters them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/base/parallel.hpp"
#include "core/volume/cloud.hpp"
#include "core/volume/cloud_marks.hpp"
#include "core/volume/volume_config.hpp"

namespace strata::volume {

/// How a config cuts rays.
[[nodiscard]] RayLimits ray_limits(const VolumeConfig& config);

/// A cloud in the map frame, rounded as OctoMap rounds it when it inserts a scan node.
struct CloudInMap {
  std::vector<RayOrigin> origins;  ///< one a part
  std::vector<Eigen::Vector3f> ends_m;
};
/// Throws InputError when a pose is not finite.
void bring_into_map(const Cloud& cloud, WorkerPool& pool, CloudInMap& in_map);

}  // namespace strata::volume
