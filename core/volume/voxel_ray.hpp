// SPDX-License-Identifier: Apache-2.0
/// The voxels that a ray passes before its end, as OctoMap's computeRayKeys gives them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "core/volume/voxel.hpp"

namespace strata::volume {

/// What `trace_ray` needs beyond the two ends: each axis' direction and crossings.
struct RayCrossings {
  std::array<std::int32_t, 3> step{};
  std::array<double, 3> next_m{};   ///< along the ray to the next border of the axis
  std::array<double, 3> every_m{};  ///< between two borders of the axis
  double length_m = 0.0;
};

/// Sums in float where OctoMap does (direction, length, half a voxel): another rounding would put
/// some rays through other voxels.
[[nodiscard]] inline RayCrossings ray_crossings(const VoxelLattice& lattice,
                                                const VoxelKey& origin_key,
                                                const Eigen::Vector3f& origin_m,
                                                const Eigen::Vector3f& end_m) {
  RayCrossings ray;
  std::array<float, 3> along{end_m.x() - origin_m.x(), end_m.y() - origin_m.y(),
                             end_m.z() - origin_m.z()};
  const float squared = along[0] * along[0] + along[1] * along[1] + along[2] * along[2];
  const auto length = static_cast<float>(std::sqrt(static_cast<double>(squared)));
  ray.length_m = static_cast<double>(length);
  const std::array<std::int32_t, 3> key{origin_key.x, origin_key.y, origin_key.z};
  for (std::size_t i = 0; i < 3; ++i) {
    along[i] /= length;
    ray.step[i] = along[i] > 0.0F ? 1 : (along[i] < 0.0F ? -1 : 0);
    ray.next_m[i] = ray.every_m[i] = std::numeric_limits<double>::max();
    if (ray.step[i] == 0) continue;
    const double border =
        lattice.center_m(key[i]) +
        static_cast<double>(static_cast<float>(ray.step[i] * lattice.resolution_m() * 0.5));
    const auto direction = static_cast<double>(along[i]);
    ray.next_m[i] = (border - static_cast<double>(origin_m[static_cast<int>(i)])) / direction;
    ray.every_m[i] = lattice.resolution_m() / std::abs(direction);
  }
  return ray;
}

/// Calls visit(VoxelKey) for the voxel of `origin_m` and every further one up to, but without, the
/// voxel of `end_m`, in order [amanatides1987fast]; nothing when both ends are in one voxel. Both
/// keys must be those of the ends. Rounding may end the walk beside the last voxel, as OctoMap's
/// does. O(voxels passed).
template <typename Visit>
void trace_ray(const VoxelLattice& lattice, const VoxelKey& origin_key, const VoxelKey& end_key,
               const Eigen::Vector3f& origin_m, const Eigen::Vector3f& end_m, Visit&& visit) {
  if (origin_key == end_key) return;
  visit(origin_key);
  RayCrossings ray = ray_crossings(lattice, origin_key, origin_m, end_m);
  VoxelKey key = origin_key;
  double x = ray.next_m[0];
  double y = ray.next_m[1];
  double z = ray.next_m[2];
  while (true) {
    if (x < y && x < z) {
      key.x += ray.step[0];
      x += ray.every_m[0];
    } else if (!(x < y) && y < z) {
      key.y += ray.step[1];
      y += ray.every_m[1];
    } else {
      key.z += ray.step[2];
      z += ray.every_m[2];
    }
    if (key == end_key || std::min(std::min(x, y), z) > ray.length_m) return;
    visit(key);
  }
}

}  // namespace strata::volume
