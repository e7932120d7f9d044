// SPDX-License-Identifier: Apache-2.0
/// The 3-D map of static space, an octree as OctoMap keeps it [hornung2013octomap].
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/geometry/pose3.hpp"
#include "core/volume/cloud_in_map.hpp"
#include "core/volume/volume_config.hpp"
#include "core/volume/voxel.hpp"

namespace strata::volume {

/// A leaf of the octree: a cube of 2^n voxels an edge that are all alike.
struct VoxelCube {
  VoxelKey corner;        ///< lowest voxel
  std::int32_t edge = 1;  ///< voxels
  float log_odds = 0.0F;  ///< of being occupied
  bool is_occupied = false;
};

/// Calls visit(VoxelKey) for each voxel of a cube.
template <typename Visit>
void for_each_voxel(const VoxelCube& cube, Visit&& visit) {
  for (std::int32_t z = 0; z < cube.edge; ++z) {
    for (std::int32_t y = 0; y < cube.edge; ++y) {
      for (std::int32_t x = 0; x < cube.edge; ++x) {
        visit(VoxelKey{cube.corner.x + x, cube.corner.y + y, cube.corner.z + z});
      }
    }
  }
}

/// How large a map is.
struct VolumeSize {
  std::size_t nodes = 0;  ///< inner ones too
  std::size_t leaves = 0;
  std::size_t bytes = 0;  ///< as OctoMap reckons: nodes and their arrays of children
};

class VolumeMap {
 public:
  /// Throws ConfigError.
  explicit VolumeMap(const VolumeConfig& config);
  ~VolumeMap();
  VolumeMap(VolumeMap&&) noexcept;
  VolumeMap& operator=(VolumeMap&&) noexcept;

  [[nodiscard]] const VolumeConfig& config() const;
  [[nodiscard]] const VoxelLattice& lattice() const;

  /// Enters one cloud: each voxel that rays passed gets one miss, each in which a point ended one
  /// hit, once a cloud. Without a box the tree is the same, node by node and bit by bit, as after
  /// OctoMap's insertPointCloud(ScanNode). is_dynamic: empty, or one flag a point; such a point
  /// frees the space before it and enters nothing. The same tree for any number of threads. Throws
  /// InputError when the pose is not finite; the map is then as before. O(voxels passed).
  CloudCounts insert(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                     WorkerPool& pool);

  /// Of the voxel at a point of the map frame; nothing where nothing is known. O(depth).
  [[nodiscard]] std::optional<float> log_odds(const Eigen::Vector3d& point_m) const;
  [[nodiscard]] bool is_occupied(float log_odds) const;
  [[nodiscard]] VolumeSize size() const;
  /// Every leaf, in Z-order.
  void for_each_cube(const std::function<void(const VoxelCube&)>& visit) const;

  /// A .bt file: occupied, free or unknown, pruned. What octovis and octomap_server open.
  [[nodiscard]] std::string binary_file() const;
  /// The map of a .bt or .ot file of an OcTree. place: its name in errors. wanted: how clouds are
  /// added from then on; nothing: the defaults. Throws InputError for a tree of another kind and
  /// for voxels of another size than wanted; DamageError or UnknownContentError for what is cut
  /// short, altered or no such file.
  [[nodiscard]] static VolumeMap from_file(const std::string& bytes, const std::string& place,
                                           const std::optional<VolumeConfig>& wanted = {});
  /// A .ot file: every log odds.
  [[nodiscard]] std::string full_file() const;
  /// The data of an octomap_msgs/Octomap with binary = true, id = "OcTree".
  [[nodiscard]] std::string binary_message_data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Calls visit(VoxelKey) for each occupied voxel, in the order of `for_each_cube`.
template <typename Visit>
void for_each_voxel(const VolumeMap& map, Visit&& visit) {
  map.for_each_cube([&](const VoxelCube& cube) {
    if (cube.is_occupied) for_each_voxel(cube, visit);
  });
}

}  // namespace strata::volume
