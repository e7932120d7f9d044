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
/// Known and at least 0.5, the threshold of the sensor models; false where unknown.
[[nodiscard]] inline bool is_occupied(float reflection) { return reflection >= 0.5F; }
/// Known and below 0.5; false where unknown.
[[nodiscard]] inline bool is_free(float reflection) { return reflection < 0.5F; }

[[nodiscard]] inline ReflectionGrid make_reflection_grid(double resolution_m,
                                                         const CellRect& rect) {
  return {resolution_m, rect, kUnknownReflection};
}

}  // namespace strata
