// SPDX-License-Identifier: Apache-2.0
/// Reflection probabilities m_j per cell: P(a beam that reaches the cell ends in it)
/// [stachniss2003chapter, section 1.2]. Unknown is a state of its own, never 0.5.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/grid/grid.hpp"

namespace strata {

/// NaN marks an unknown cell; test with is_known, not with ==.
using ReflectionGrid = Grid<float>;

inline constexpr float kUnknownReflection = std::numeric_limits<float>::quiet_NaN();

[[nodiscard]] inline bool is_known(float reflection) { return !std::isnan(reflection); }
/// What is there most of the time, by what most beams say: a state of the cell, not the few beams
/// that graze something.
inline constexpr float kMostlyOccupied = 0.5F;
/// Cells that a surface runs through at all, even where most beams only graze it: to match a scan
/// with, where too many cells do little harm and missing ones make gaps.
inline constexpr double kSurfaceReflection = 0.1;
/// From here on a cell counts as an obstacle. Beams that graze a wall pass through a part of its
/// cells, and walls on a border of cells share their hits between two, so that at 0.5 whole walls
/// of a corridor go missing, most of all in the filtered map, whose values lie below the share of
/// hits (docs/theory/beam_filter.md, "Departures"). Above its own threshold (0.11 at p = 0.9).
inline constexpr float kOccupiedReflection = 0.25F;
/// Known and at least kOccupiedReflection; false where unknown.
[[nodiscard]] inline bool is_occupied(float reflection) {
  return reflection >= kOccupiedReflection;
}
/// Known and below kOccupiedReflection; false where unknown.
[[nodiscard]] inline bool is_free(float reflection) { return reflection < kOccupiedReflection; }

/// Whether a cell or one of the eight around it is_occupied.
[[nodiscard]] inline bool is_by_a_wall(const ReflectionGrid& map, const Cell& cell) {
  return any_beside(cell, [&](const Cell& other) { return is_occupied(map.get(other)); });
}
/// 1 where is_occupied.
[[nodiscard]] inline Grid<std::uint8_t> occupied_cells(const ReflectionGrid& map) {
  Grid<std::uint8_t> occupied(map.resolution_m(), map.rect(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    occupied.values()[i] = is_occupied(map.values()[i]) ? 1 : 0;
  }
  return occupied;
}

[[nodiscard]] inline ReflectionGrid make_reflection_grid(double resolution_m,
                                                         const CellRect& rect) {
  return {resolution_m, rect, kUnknownReflection};
}

}  // namespace strata
