// SPDX-License-Identifier: Apache-2.0
/// How the frame of one map lies against that of another of the same building.
#pragma once

#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::site {

struct MapShift {
  Pose2 from_moved;           ///< takes a point of the moved map to where it is in the fixed one
  double shift_m = 0.0;       ///< of the middle of the moved map's walls
  double turn_rad = 0.0;      ///< without sign
  double common_walls = 0.0;  ///< share of the moved map's walls that lie on the fixed one's, after
  bool converged = false;     ///< false: their walls do not fit, and the rest says little
};

/// Of the cells that `of` knows, the share that `in` knows too. Requires one lattice. O(cells).
[[nodiscard]] double known_share(const ReflectionGrid& of, const ReflectionGrid& in);

/// Registers the walls of `moved`, where `fixed` knows anything, with those of `fixed`, coarse to
/// fine, from where both frames are the same. Requires one lattice. O(cells).
[[nodiscard]] MapShift map_shift(const ReflectionGrid& fixed, const ReflectionGrid& moved);

}  // namespace strata::site
