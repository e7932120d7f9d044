// SPDX-License-Identifier: Apache-2.0
/// Grid maps: nav_msgs/OccupancyGrid for others, strata_msgs/ReflectionGrid without loss.
#pragma once

#include <string>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/strata_msgs.h"

#include "core/base/time.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::convert {

/// Percent of occupancy, -1 where unknown. The origin is the corner of the least cell.
[[nodiscard]] nav_msgs::msg::OccupancyGrid to_occupancy(const ReflectionGrid& grid, Stamp stamp,
                                                        const std::string& frame);
/// Percent / 100, unknown where -1. The origin is moved to the nearest point of our lattice (by at
/// most half a cell); throws InputError for a turned map, a resolution that is not positive, or a
/// size that does not fit the data.
[[nodiscard]] ReflectionGrid from_message(const nav_msgs::msg::OccupancyGrid& message);

[[nodiscard]] strata_msgs::msg::CellRect to_message(const CellRect& rect);
[[nodiscard]] CellRect from_message(const strata_msgs::msg::CellRect& rect);
/// Bit for bit. Reading throws InputError when the values do not fill the rectangle.
[[nodiscard]] strata_msgs::msg::ReflectionGrid to_message(const ReflectionGrid& grid);
[[nodiscard]] ReflectionGrid from_message(const strata_msgs::msg::ReflectionGrid& message);
[[nodiscard]] strata_msgs::msg::CountGrid to_message(const Grid<CellCounts>& grid);
[[nodiscard]] Grid<CellCounts> from_message(const strata_msgs::msg::CountGrid& message);

}  // namespace strata::convert
