// SPDX-License-Identifier: Apache-2.0
/// The walls of a floor plan, as bodies.
#pragma once

#include "core/grid/reflection_grid.hpp"

namespace strata::plan {

/// The plan without letters, numbers and symbols (lines that hang together within less than 0.6 m
/// and touch no others; solid pillars of at least 0.15 m stay), and with gaps narrower than 0.3 m
/// filled: between the two lines of a wall nobody looks. O(cells).
[[nodiscard]] ReflectionGrid drawn_walls(const ReflectionGrid& plan);

}  // namespace strata::plan
