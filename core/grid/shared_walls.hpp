// SPDX-License-Identifier: Apache-2.0
/// Whether two maps are of one building in one frame.
#pragma once

#include "core/grid/reflection_grid.hpp"

namespace strata {

/// Share of the occupied cells of `before` that are occupied in `now`, or have a neighbour that is;
/// 1 when there are none. Both have one resolution. O(cells of before).
[[nodiscard]] double shared_walls(const ReflectionGrid& before, const ReflectionGrid& now);

}  // namespace strata
