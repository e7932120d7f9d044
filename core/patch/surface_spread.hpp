// SPDX-License-Identifier: Apache-2.0
/// How much of what passed through a cell went across a surface, rather than along it.
///
/// A beam that grazes a surface runs beside it: with an error of pose, or a wall that ends within a
/// cell, it passes through the very cells that beams from elsewhere end in, though nothing moved.
/// It would have passed just so had the surface stood where it was seen, and so tells nothing of
/// whether it stood there. A beam that goes across comes out on the other side, whatever the error
/// of pose. So a visit finds a surface gone only by beams that went across it (ours;
/// docs/theory/patch_maps.md, "Many visits").
#pragma once

#include <span>

#include "core/grid/grid.hpp"
#include "core/patch/visits.hpp"

namespace strata::patch {

/// The spread of a surface's cells: their covariance C, each cell with its own square, over its
/// greatest eigenvalue.
class SurfaceSpread {
 public:
  /// Requires a cell. O(cells).
  explicit SurfaceSpread(std::span<const Cell> cells);

  /// Evidence of the visit's passing beams that went across, in beams: each counts its length in
  /// the cell (units of the resolution) times what of the surface's spread lies across the beam, n'
  /// C n for n normal to it. For a line at an angle a to the beam that is sin^2 a; a surface
  /// without a direction (a pillar, a corner) is crossed by every beam. At most the misses. O(1).
  [[nodiscard]] double misses_across(const Visit& visit) const;
  /// Whether so many beams went across, or most of what passed: a single oblique beam does not
  /// graze. O(1).
  [[nodiscard]] bool is_crossed_by(const Visit& visit, double min_across) const;
  /// How far the cells reach along their longest direction, in cells, or along the rows or columns
  /// where that is more: 8 for eight in a row, and no less when the row lies askew. Of the cells it
  /// was made of. O(cells).
  [[nodiscard]] double extent(std::span<const Cell> cells) const;

 private:
  double mean_ = 0.0;  // of n' C n over all directions
  double cos2_ = 0.0;  // n' C n = mean - (cos2, sin2) . axis of the beam
  double sin2_ = 0.0;
};

}  // namespace strata::patch
