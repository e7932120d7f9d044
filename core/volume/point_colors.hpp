// SPDX-License-Identifier: Apache-2.0
/// Colours of voxels from the points that ended in them, cloud by cloud
/// (docs/theory/static_3d.md, "Colours").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/volume/brick_map.hpp"
#include "core/volume/cloud.hpp"
#include "core/volume/cloud_in_map.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume {

/// A voxel has the mean colour of a cloud's points in it, a cloud counting once; of more than
/// kRemembered clouds, the old ones fade.
class PointColors {
 public:
  static constexpr std::uint8_t kRemembered = 16;

  explicit PointColors(const VolumeConfig& config);

  /// is_dynamic: as of VolumeMap::insert; such points colour nothing. A cloud without colours
  /// changes nothing. Throws InputError when a pose is not finite. O(points).
  void add(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic, WorkerPool& pool);

  /// Nothing where no coloured point ended.
  [[nodiscard]] std::optional<Rgb> color(const VoxelKey& key) const;
  [[nodiscard]] bool is_empty() const { return bricks_.size() == 0; }

  /// As of color_tree.hpp; voxels of the map without colour are grey.
  [[nodiscard]] std::string file(const VolumeMap& map) const;
  [[nodiscard]] std::string message_data(const VolumeMap& map) const;
  /// Takes the colours of such a file as those of one cloud. Throws as VolumeMap::from_file.
  void restore(const std::string& bytes, const std::string& place);

 private:
  struct Brick {
    std::array<std::array<std::uint16_t, 3>, kBrickVoxels> mean{};  ///< in 1 / 256
    std::array<std::uint8_t, kBrickVoxels> clouds{};
  };
  struct Sums {
    std::array<std::array<std::uint32_t, 3>, kBrickVoxels> sum{};
    std::array<std::uint32_t, kBrickVoxels> points{};
  };
  [[nodiscard]] Rgb color_or_grey(const VoxelKey& key) const;
  void learn(const VoxelKey& key, const std::array<double, 3>& rgb);

  VoxelLattice lattice_;
  RayLimits limits_;
  BrickMap<Brick> bricks_;
  CloudInMap in_map_;    ///< the present cloud
  BrickMap<Sums> sums_;  ///< of it
};

}  // namespace strata::volume
