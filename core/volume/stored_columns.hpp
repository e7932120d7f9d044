// SPDX-License-Identifier: Apache-2.0
/// Whether clouds see the walls of a map of before. Floors say nothing: they lie at one height in
/// every frame.
#pragma once

#include <cstdint>

#include "core/grid/frame_watch.hpp"
#include "core/grid/tiled_grid.hpp"
#include "core/volume/cloud.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume {

/// The upright columns of voxels of a map as it was when this was made: where walls stand, and
/// where nothing does. Two bytes a column.
class StoredColumns {
 public:
  /// O(voxels that are known).
  explicit StoredColumns(const VolumeMap& map);

  /// How many of the columns in which the cloud has points at several heights are walls, or beside
  /// one; columns of which the map knows nothing are left out. Points that are no numbers, or
  /// outside of the map, are none. O(points log points).
  [[nodiscard]] FrameLook agreement(const Cloud& cloud) const;

 private:
  struct Column {
    std::uint8_t occupied = 0;  ///< voxels, at most 255
    std::uint8_t free = 0;
  };
  [[nodiscard]] bool is_by_a_wall(const Cell& column) const;

  VoxelLattice lattice_;
  TiledGrid<Column> columns_;
};

}  // namespace strata::volume
