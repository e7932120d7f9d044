// SPDX-License-Identifier: Apache-2.0
/// Exact Euclidean distance from every cell centre to the nearest occupied cell centre.
#pragma once

#include <cstdint>

#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata {

/// Distances in metres; +Inf everywhere when no cell is occupied. Outside the grid: +Inf.
using DistanceField = Grid<float>;

/// Exact two-pass transform of [felzenszwalb2012distance] over squared integer cell distances, so
/// the result is the same bits everywhere. max_distance_m > 0 cuts the values there (the transform
/// is still exact below). O(cells).
[[nodiscard]] DistanceField make_distance_field(const Grid<std::uint8_t>& occupied,
                                                double max_distance_m = 0.0);
/// Occupied: is_occupied (known and at least kOccupiedReflection).
[[nodiscard]] DistanceField make_distance_field(const ReflectionGrid& map,
                                                double max_distance_m = 0.0);

}  // namespace strata
