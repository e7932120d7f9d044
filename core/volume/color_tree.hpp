// SPDX-License-Identifier: Apache-2.0
/// Coloured maps as OctoMap keeps them.
#pragma once

#include <functional>
#include <string>

#include "core/volume/rgb.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume {

/// Asked once for each occupied voxel, in the order of `for_each_voxel`.
using ColorOf = std::function<Rgb(const VoxelKey&)>;

/// A .ot file of OctoMap's ColorOcTree with the log odds of the map; free space is white.
[[nodiscard]] std::string color_file(const VolumeMap& map, const ColorOf& color_of);
/// The data of an octomap_msgs/Octomap with binary = false, id = "ColorOcTree".
[[nodiscard]] std::string color_message_data(const VolumeMap& map, const ColorOf& color_of);

/// Calls visit for each occupied voxel of a file that `color_file` made. resolution_m: what its
/// voxels must have. Throws as VolumeMap::from_file.
void read_color_file(const std::string& bytes, const std::string& place, double resolution_m,
                     const std::function<void(const VoxelKey&, const Rgb&)>& visit);

}  // namespace strata::volume
