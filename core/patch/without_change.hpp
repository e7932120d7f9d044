// SPDX-License-Identifier: Apache-2.0
/// Patch maps in which some cells do not change.
#pragma once

#include <cstdint>

#include "core/grid/grid.hpp"
#include "core/patch/patch_map.hpp"

namespace strata::patch {

/// In cells with a value of `cells` every configuration becomes what the base says, and sub-maps
/// that contradict themselves nowhere else go; ids stay places in the vector. O(cells of the
/// sub-maps).
void keep_static(PatchMap& map, const Grid<std::uint8_t>& cells);

}  // namespace strata::patch
