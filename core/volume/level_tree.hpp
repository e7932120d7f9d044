// SPDX-License-Identifier: Apache-2.0
/// Levels of voxels as maps of OctoMap's.
#pragma once

#include <string>

#include "core/volume/voxel_memory.hpp"

namespace strata::volume {

/// The voxels of a level in a .bt file: occupied where at least half of the clouds of its time
/// ended, else free; unknown where none looked. O(known voxels).
[[nodiscard]] std::string level_file(const VoxelMemory& memory, VoxelLevel level);
/// The same as data of an octomap_msgs/Octomap with binary = true, id = "OcTree".
[[nodiscard]] std::string level_message_data(const VoxelMemory& memory, VoxelLevel level);

}  // namespace strata::volume
