// SPDX-License-Identifier: Apache-2.0
/// Reflection probabilities m_j per cell: P(a beam that reaches the cell ends in it)
/// [stachniss2003chapter, section 1.2]. Unknown is a state of its own, never 0.5.
#pragma once

#include <cmath>
#include <limits>

#include "core/grid/grid.hpp"

namespace strata {

/// NaN marks an unknown cell; test with is_known, not with ==.
using ReflectionGrid = Grid<float>;

inline constexpr float kUnknownReflection = std::numeric_limits<float>::quiet_NaN();

[[nodiscard]] inline bool is_known(float reflection) { return !std::isnan(reflection); }
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

[[nodiscard]] inline ReflectionGrid make_reflection_grid(double resolution_m,
                                                         const CellRect& rect) {
  return {resolution_m, rect, kUnknownReflection};
}

}  // namespace strata
