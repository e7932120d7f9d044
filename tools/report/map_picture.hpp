// SPDX-License-Identifier: Apache-2.0
/// Pictures of maps: white free, black occupied, grey unknown, as robot maps are drawn.
#pragma once

#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"
#include "tools/report/image.hpp"

namespace strata::report {

/// A map drawn at a whole number of pixels a cell, north up.
struct MapPicture {
  Image image;
  CellRect rect;  ///< what part of the lattice it shows
  double resolution_m = 0.05;
  int pixels_per_cell = 1;

  /// Pixel of a point in the map frame, {x, y} from the upper left.
  [[nodiscard]] Eigen::Vector2i pixel(const Eigen::Vector2d& point_m) const;
};

/// The smallest rectangle with all known cells, grown by `margin`; the whole rectangle when none
/// is.
[[nodiscard]] CellRect known_rect(const ReflectionGrid& map, int margin = 10);

/// Draws `rect` of a map so that the longer side has about `max_pixels` pixels (at least 1 pixel a
/// cell, so larger maps come out larger).
[[nodiscard]] MapPicture draw_map(const ReflectionGrid& map, const CellRect& rect, int max_pixels);

/// Marks the ends of the beams whose static probability is below one half (figures 1.4 to 1.6 of
/// [stachniss2003chapter]).
void mark_dynamic_beams(MapPicture& picture, std::span<const PosedScan> scans, Color color);

void mark_trajectory(MapPicture& picture, std::span<const Pose2> poses, Color color);

/// A dot at each point of the map frame.
void mark_points(MapPicture& picture, std::span<const Eigen::Vector2d> points_m, Color color);

/// Outlines of all sub-maps.
void mark_submaps(MapPicture& picture, const patch::PatchMap& map, Color color);

/// The configurations of one sub-map side by side, as in figures 1.11 and 1.12 of
/// [stachniss2003chapter].
[[nodiscard]] Image draw_submap(const patch::Submap& submap, int pixels_per_cell);

}  // namespace strata::report
