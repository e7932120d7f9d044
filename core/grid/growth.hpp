// SPDX-License-Identifier: Apache-2.0
/// Growing grids that a robot drives through for hours.
#pragma once

#include "core/grid/grid.hpp"

namespace strata {

/// What to hand to grow() of a grid on `now` so that it covers `needed` and rarely has to grow
/// again: on the sides where it must grow, a quarter of its extent more. Growing to n cells step by
/// step then costs O(n) in all, and an axis is never more than a quarter (and a constant) longer
/// than needed in each direction.
[[nodiscard]] inline CellRect with_room(const CellRect& now, const CellRect& needed) {
  if (now.empty() || needed.empty()) return needed;
  const int room_x = now.width() / 4;
  const int room_y = now.height() / 4;
  CellRect result = needed;
  if (needed.min.x < now.min.x) result.min.x -= room_x;
  if (needed.min.y < now.min.y) result.min.y -= room_y;
  if (needed.max.x > now.max.x) result.max.x += room_x;
  if (needed.max.y > now.max.y) result.max.y += room_y;
  return result;
}

}  // namespace strata
