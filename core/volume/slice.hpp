// SPDX-License-Identifier: Apache-2.0
/// Flat maps cut out of a 3-D map.
#pragma once

#include "core/grid/reflection_grid.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume {

/// The columns of voxels whose middles lie in [from_m, to_m): 1 where one is occupied, else 0 where
/// one is free, else unknown. Cells are the lattice's, so that grids of one resolution are aligned.
/// An empty grid when nothing is known there. O(leaves + cells).
[[nodiscard]] ReflectionGrid slice(const VolumeMap& map, double from_m, double to_m);

}  // namespace strata::volume
