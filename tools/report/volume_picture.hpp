// SPDX-License-Identifier: Apache-2.0
/// Pictures of 3-D maps, drawn without a display.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/volume/color_map.hpp"
#include "core/volume/volume_map.hpp"
#include "tools/report/image.hpp"

namespace strata::report {

/// A cube to draw.
struct ColoredCube {
  Eigen::Vector3d corner_m = Eigen::Vector3d::Zero();  ///< lowest corner, map frame
  double edge_m = 0.1;
  Color color;
};

/// A camera.
struct VolumeView {
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d towards_m = Eigen::Vector3d::UnitX();
  /// Full angle across the picture; 0: parallel rays, and the picture is `width_m` across.
  double field_of_view_rad = 0.0;
  double width_m = 10.0;
  int width = 900;
  int height = 600;
};

/// Blue low, over green, to red high; `share` in [0, 1].
[[nodiscard]] Color height_color(double share);

/// The occupied cubes below `ceiling_m`, coloured by height.
[[nodiscard]] std::vector<ColoredCube> occupied_cubes(
    const volume::VolumeMap& map, double ceiling_m = std::numeric_limits<double>::infinity());

/// The occupied cubes below `ceiling_m` in the colours of `colors`.
[[nodiscard]] std::vector<ColoredCube> colored_cubes(
    const volume::ColorMap& colors, const volume::VoxelLattice& lattice,
    double ceiling_m = std::numeric_limits<double>::infinity());

/// Draws every face that looks at the camera, nearest first wins; faces are shaded by direction.
/// O(cubes + pixels they cover).
[[nodiscard]] Image draw_cubes(std::span<const ColoredCube> cubes, const VolumeView& view);

/// From straight above; pixels per metre as fit into max_pixels.
[[nodiscard]] VolumeView view_from_above(std::span<const ColoredCube> cubes, int max_pixels);
/// Obliquely from outside: azimuth_rad is where the camera stands, seen from the middle.
[[nodiscard]] VolumeView view_from_outside(std::span<const ColoredCube> cubes, double azimuth_rad,
                                           double elevation_rad, int max_pixels);

}  // namespace strata::report
