// SPDX-License-Identifier: Apache-2.0
/// The faces of walls, as a map saw them and as a floor plan draws them: what both have in common,
/// however thick a wall is drawn.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/grid/reflection_grid.hpp"
#include "core/grid/surface_layer.hpp"

namespace strata::plan {

/// A piece of a face about as long as a cell.
struct WallFace {
  Eigen::Vector2d at_m;
  Eigen::Vector2d normal;  ///< unit; to the side that is free
};

/// Of occupied cells by free ones. A wall that was seen from both sides has a face to each, at the
/// same place. surfaces: where in the cells the hits lie; may be empty. O(occupied cells).
[[nodiscard]] std::vector<WallFace> seen_faces(const ReflectionGrid& map,
                                               const SurfaceLayer& surfaces = {});

/// Of the edges of what is drawn; what is not occupied counts as free. O(cells).
[[nodiscard]] std::vector<WallFace> drawn_faces(const ReflectionGrid& plan);

/// At most one a square of that size and direction (of 8). Keeps the order.
[[nodiscard]] std::vector<WallFace> thinned(const std::vector<WallFace>& faces, double square_m);

/// Which of the 8 directions a normal has. O(1).
inline constexpr int kDirections = 8;
[[nodiscard]] int direction_of(const Eigen::Vector2d& normal);

}  // namespace strata::plan
