// SPDX-License-Identifier: Apache-2.0
/// Many rays from one place at once, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>
#include <cstdint>

namespace strata::rays {

/// What a RayWalker walks through: cells that a ray may skip from anywhere in a cell, row by row;
/// below 0: -mark.
struct RayTable {
  const float* empty_skips = nullptr;
  std::int32_t width = 0;
  std::int32_t height = 0;
  double min_x = 0.0;  ///< lattice coordinates of the corner
  double min_y = 0.0;
  double resolution_m = 0.05;

  /// A place in the map in cells, relative to the corner.
  [[nodiscard]] double column_at(double x_m) const { return x_m / resolution_m - min_x; }
  [[nodiscard]] double row_at(double y_m) const { return y_m / resolution_m - min_y; }
};

/// Rays from (x_m, y_m). Ray k points in the direction (cosine[k], sine[k]) of a laser that is
/// itself turned by (heading_cosine, heading_sine).
struct BeamBundle {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_cosine = 1.0;
  double heading_sine = 0.0;
  const double* cosine = nullptr;
  const double* sine = nullptr;
  std::size_t count = 0;
  double max_range_m = 0.0;
};

/// range_m[k]: to the middle of ray k's way through the first marked cell, +infinity when it meets
/// none; cell[k]: the place of that cell in the table, -1 for none. The same bits as
/// RayWalker::walk on every SIMD target. Requires finite numbers.
void cast_rays(const RayTable& table, const BeamBundle& bundle, double* range_m,
               std::int32_t* cell);

/// Rays from anywhere, one entry each, and room for kSlack more, of which nothing is said. Ray k is
/// looked at from from_m[k] to to_m[k] along it, and goes through cells of mark skip[k] as if they
/// were free.
struct RayBatch {
  static constexpr std::size_t kSlack = 8;
  const double* column = nullptr;  ///< where it starts: column_at, row_at of the table
  const double* row = nullptr;
  const double* cosine = nullptr;
  const double* sine = nullptr;
  const double* from_m = nullptr;
  const double* to_m = nullptr;
  const double* skip = nullptr;
  std::size_t count = 0;
  double max_range_m = 0.0;  ///< where the beams themselves end
};

/// As cast_rays, with the mark of the cell met (RayWalker::mark) in place of its number; 0: none.
/// Requires finite numbers, and that the rays are inside the table from from_m to to_m. range_m,
/// mark: with the same room.
void cast_batch(const RayTable& table, const RayBatch& batch, double* range_m, std::int32_t* mark);

}  // namespace strata::rays
