// SPDX-License-Identifier: Apache-2.0
/// Polygons in metres, and the cells that they cover.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/grid/cell_outline.hpp"
#include "core/grid/grid.hpp"

namespace strata {

/// Corners in metres; the last is joined with the first. A ring that crosses itself holds what lies
/// in it an odd number of times.
using MetricRing = std::vector<Eigen::Vector2d>;

/// What lies in the outer ring and in no hole.
struct MetricPolygon {
  MetricRing outer;
  std::vector<MetricRing> holes;
};

/// Positive counterclockwise, in square metres. O(corners).
[[nodiscard]] double signed_area_m2(const MetricRing& ring);
/// Of the outer ring without the holes. O(corners).
[[nodiscard]] double area_m2(const MetricPolygon& polygon);

/// Whether a point lies in it; one on a border may lie on either side. O(corners).
[[nodiscard]] bool contains(const MetricPolygon& polygon, const Eigen::Vector2d& point_m);

/// The smallest rectangle with all cells whose middle the polygon may contain.
[[nodiscard]] CellRect cells_around(const MetricPolygon& polygon, double resolution_m);

/// 1 for each cell of `rect` whose middle the polygon contains; of the part of `rect` that the
/// polygon reaches. Requires finite corners. O(cells + corners x rows that an edge crosses).
[[nodiscard]] Grid<std::uint8_t> cells_in(const MetricPolygon& polygon, double resolution_m,
                                          const CellRect& rect);

/// In metres: on borders of cells, so that cells_in gives the same cells back. O(corners).
[[nodiscard]] MetricPolygon to_metric(const CellPolygon& polygon, double resolution_m);

}  // namespace strata
