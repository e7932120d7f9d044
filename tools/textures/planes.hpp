// SPDX-License-Identifier: Apache-2.0
/// The flat surfaces of a 3-D map, grown from voxel to voxel.
#pragma once

#include <cstddef>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/volume/color_map.hpp"
#include "core/volume/voxel.hpp"

namespace strata::textures {

struct PlaneConfig {
  double max_off_voxels = 0.75;
  double max_angle_rad = 0.35;
  int min_voxels = 30;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("max_off_voxels", c.max_off_voxels,
            {.doc = "middles of voxels may lie this far from their plane",
             .unit = "voxels",
             .min = 0.1});
    v.field("max_angle_rad", c.max_angle_rad,
            {.doc = "what is around a voxel may be turned by this against its plane",
             .unit = "rad",
             .min = 0.0,
             .max = 1.5});
    v.field("min_voxels", c.min_voxels, {.doc = "smaller surfaces are left out", .min = 3});
  }
};

/// Voxels by their place on the lattice.
struct KeyHash {
  std::size_t operator()(const volume::VoxelKey& key) const {
    return (static_cast<std::size_t>(key.x) << 32) ^ (static_cast<std::size_t>(key.y) << 16) ^
           static_cast<std::size_t>(key.z);
  }
};
using VoxelIndex = std::unordered_map<volume::VoxelKey, std::size_t, KeyHash>;
[[nodiscard]] VoxelIndex index_of(std::span<const volume::ColoredVoxel> voxels);

/// A flat surface in the map frame; u, v and the normal are a right-handed frame. On upright
/// surfaces u is level, on level ones x.
struct Plane {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< middle of its voxels
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< of either sign
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();
  std::vector<std::size_t> voxels;  ///< ascending; a voxel where two planes meet may be of both
};

/// Largest first. Normals are those of the voxels within two of each; growing begins where
/// surroundings are flattest. Throws ConfigError. O(voxels log voxels).
[[nodiscard]] std::vector<Plane> find_planes(std::span<const volume::ColoredVoxel> voxels,
                                             const volume::VoxelLattice& lattice,
                                             const PlaneConfig& config);

}  // namespace strata::textures
