// SPDX-License-Identifier: Apache-2.0
/// Surfaces that seem to have changed only because the poses of two visits disagree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.hpp"
#include "core/patch/contradiction.hpp"
#include "core/patch/visits.hpp"

namespace strata::patch {

/// Offsets of the other cells within a radius; at least the eight neighbours.
[[nodiscard]] std::vector<Cell> disc_offsets(double radius_m, double resolution_m);

/// Whether a visit that shares time with `visit`, one of the cell's, hit one of the cells at the
/// offsets from `cell`. Where the visit was cut by a change in view, cells whose share of hits is
/// at most free_share were not: in a long visit many people may have stood at a cell that was free.
/// O(visits of the cell + offsets x log visits).
[[nodiscard]] bool was_hit_nearby(const VisitTable& table, const Cell& cell, const Visit& visit,
                                  std::span<const Cell> offsets, double free_share);

/// Clears the components (CellLink::kOverAGap) that a displaced surface explains: where the
/// component was free, the same visit hit something within displaced_reach_m, nearly all along it.
/// An open door has its frame near, but only at its ends; a wall that moved with the pose is near
/// everywhere. Likewise where nearly all of it lies that close to surfaces that several visits hit
/// and none found free: a thin wall seen from its other side, or a corner passed at a grazing
/// angle.
void drop_displaced_surfaces(const VisitTable& table, const ContradictionConfig& config,
                             Grid<std::uint8_t>& mask);

}  // namespace strata::patch
