// SPDX-License-Identifier: Apache-2.0
/// The surfaces that scans with final poses show.
#pragma once

#include <span>

#include "core/grid/surface_layer.hpp"
#include "core/scan/scan.hpp"

namespace strata::slam {

/// The mean of the static hits in every cell, and which way the surface runs there by the sweeps
/// that saw it (docs/theory/slam.md, "Registration"). Cells of people and noise are there as well:
/// whether a cell is occupied is the map's to say. Deterministic. O(beams).
[[nodiscard]] SurfaceLayer learned_surfaces(std::span<const PosedScan> scans, double resolution_m);

}  // namespace strata::slam
