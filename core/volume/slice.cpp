// SPDX-License-Identifier: Apache-2.0
#include "core/volume/slice.hpp"

#include <algorithm>
#include <vector>

namespace strata::volume {
namespace {

/// Whether the middle of one of a cube's voxels lies in the slice.
bool reaches(const VoxelCube& cube, const VoxelLattice& lattice, double from_m, double to_m) {
  for (std::int32_t z = 0; z < cube.edge; ++z) {
    const double middle = lattice.center_m(cube.corner.z + z);
    if (middle >= from_m && middle < to_m) return true;
  }
  return false;
}

CellRect columns_of(const VoxelCube& cube) {
  const Cell corner{cube.corner.x - kLatticeMiddle, cube.corner.y - kLatticeMiddle};
  return {corner, {corner.x + cube.edge, corner.y + cube.edge}};
}

}  // namespace

ReflectionGrid slice(const VolumeMap& map, double from_m, double to_m) {
  std::vector<VoxelCube> cubes;
  CellRect rect;
  map.for_each_cube([&](const VoxelCube& cube) {
    if (!reaches(cube, map.lattice(), from_m, to_m)) return;
    cubes.push_back(cube);
    rect = rect.united(columns_of(cube));
  });
  ReflectionGrid grid = make_reflection_grid(map.lattice().resolution_m(), rect);
  for (const VoxelCube& cube : cubes) {
    const CellRect columns = columns_of(cube);
    for (int y = columns.min.y; y < columns.max.y; ++y) {
      for (int x = columns.min.x; x < columns.max.x; ++x) {
        float& cell = grid.at({x, y});
        const float value = cube.is_occupied ? 1.0F : 0.0F;
        cell = is_known(cell) ? std::max(cell, value) : value;
      }
    }
  }
  return grid;
}

}  // namespace strata::volume
