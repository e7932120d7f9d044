// SPDX-License-Identifier: Apache-2.0
/// Scans without what they say of some cells.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/grid/grid.hpp"
#include "core/scan/scan.hpp"

namespace strata {

/// Takes back the beams that end in a cell with a value of `cells`, or cross one, as far as they
/// were measured or, without a return, could have been: they become invalid, so that whoever learns
/// from the scan hears nothing of those cells. Returns how many. A scan whose pose is not finite
/// stays as it is. O(beams x cells that they cross).
std::size_t blind_beams(PosedScan& scan, const Grid<std::uint8_t>& cells);

}  // namespace strata
