// SPDX-License-Identifier: Apache-2.0
/// Maps as ROS map_server and nav2 keep them: an image and a YAML file.
#pragma once

#include <filesystem>

#include "core/grid/reflection_grid.hpp"

namespace strata::log {

/// Reads name.yaml and the PGM (P5 or P2) it names. mode trinary: occupied 1, free 0, unknown NaN;
/// scale: in between; raw is refused. The origin is moved to the nearest point of our lattice, by
/// at most half a cell. Throws InputError, also for a missing, cut or turned image.
[[nodiscard]] ReflectionGrid read_map(const std::filesystem::path& yaml);

/// Writes name.yaml and name.pgm, trinary (0 occupied, 254 free, 205 unknown), cropped to the known
/// cells. Both are written aside and renamed, the image first. Throws OutputError.
void write_map(const std::filesystem::path& yaml, const ReflectionGrid& grid);

}  // namespace strata::log
