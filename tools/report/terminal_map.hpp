// SPDX-License-Identifier: Apache-2.0
/// A small map for a terminal, in braille: eight dots a character, north up.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::report {

/// A drive through a map: poses in the map frame [m, rad].
using TerminalWay = std::vector<Pose2>;

/// What a terminal can show.
struct TerminalShape {
  int columns = 80;    ///< no line is longer
  int rows = 20;       ///< no more lines of map
  bool color = false;  ///< the way in colour (ECMA-48); else it is drawn in bullets
};

/// Obstacles and the ways driven, in UTF-8, the metres it shows in a last line. A dot is a square
/// of whole cells, as small as fits the shape, and set where any of them is_occupied. Ways are
/// drawn where they leave what is known, too; those that leap more than kLeap_m are broken there.
/// Empty when neither anything is known nor driven, or the shape has no room. O(cells + way / dot).
[[nodiscard]] std::string terminal_map(const ReflectionGrid& map, std::span<const TerminalWay> ways,
                                       const TerminalShape& shape);

/// Robots that were found again elsewhere did not drive there.
inline constexpr double kLeap_m = 2.0;

}  // namespace strata::report
