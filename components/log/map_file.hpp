// SPDX-License-Identifier: Apache-2.0
/// Maps as ROS map_server and nav2 keep them: an image and a YAML file.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "core/grid/reflection_grid.hpp"

namespace strata::log {

/// How pixels stand for occupancy.
enum class MapMode {
  kTrinary,  ///< occupied, free or unknown
  kScale,    ///< the darker the likelier occupied; transparent where unknown
  kRaw       ///< 0 to 100 percent as they are; 255 where unknown
};
/// Of "trinary", "scale" or "raw"; none for another name.
[[nodiscard]] std::optional<MapMode> map_mode(std::string_view name);

enum class MapImageFormat { kPgm, kPng };

struct MapFileFormat {
  MapImageFormat image = MapImageFormat::kPgm;
  MapMode mode = MapMode::kTrinary;
  double occupied = 0.65;  ///< what is darker reads as occupied
  double free = 0.19;      ///< what is brighter reads as free
};

/// Reads name.yaml and the PGM (P5 or P2), PNG or BMP it names, as nav2's map_server does. mode
/// trinary: occupied 1, free 0, unknown NaN; scale and raw: in between. The origin is moved to the
/// nearest point of our lattice, by at most half a cell. Throws InputError, also for a missing, cut
/// or turned image.
[[nodiscard]] ReflectionGrid read_map(const std::filesystem::path& yaml);

/// Writes name.yaml and name.pgm or name.png, cropped to the known cells. Trinary: 0 occupied, 254
/// free, unknown 205 or, where that is not between the thresholds, what is. Both are written aside
/// and renamed, the image first. Throws InputError for scale as PGM and for thresholds with nothing
/// between them, OutputError.
void write_map(const std::filesystem::path& yaml, const ReflectionGrid& grid,
               const MapFileFormat& format = {});

}  // namespace strata::log
