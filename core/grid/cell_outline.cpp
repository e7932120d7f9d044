// SPDX-License-Identifier: Apache-2.0
#include "core/grid/cell_outline.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace strata {
namespace {

/// A side of a cell with the cell on its left, by where it begins; two may begin at a corner where
/// cells touch.
using Sides = std::map<std::pair<int, int>, std::vector<Cell>>;  // (y, x) -> directions

Cell left_of(const Cell& direction) { return {-direction.y, direction.x}; }

/// Takes the side on from `at` that turns left most, so that cells that only touch come apart.
Cell take_next(Sides& sides, const Cell& at, const Cell& direction) {
  std::vector<Cell>& there = sides.at({at.y, at.x});
  auto next = there.begin();
  for (auto one = there.begin(); one != there.end(); ++one) {
    if (*one == left_of(direction)) next = one;
  }
  const Cell taken = *next;
  there.erase(next);
  if (there.empty()) sides.erase({at.y, at.x});
  return taken;
}

CellRing take_ring(Sides& sides) {
  const auto& [place, directions] = *sides.begin();
  const Cell start{place.second, place.first};
  CellRing ring;
  Cell at = start;
  Cell direction = take_next(sides, at, left_of(directions.front()));
  const Cell first = direction;
  do {
    at = {at.x + direction.x, at.y + direction.y};
    const Cell next = at == start ? first : take_next(sides, at, direction);
    if (!(next == direction)) ring.push_back(at);
    direction = next;
  } while (!(at == start));
  return ring;
}

/// Whether the middle of the cell right above and right of a corner lies in a ring.
bool holds(const CellRing& ring, const Cell& corner) {
  bool inside = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Cell& a = ring[i];
    const Cell& b = ring[(i + 1) % ring.size()];
    const bool crosses = std::min(a.y, b.y) <= corner.y && corner.y < std::max(a.y, b.y);
    if (a.x == b.x && crosses && a.x <= corner.x) inside = !inside;
  }
  return inside;
}

}  // namespace

double signed_area(const CellRing& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Cell& a = ring[i];
    const Cell& b = ring[(i + 1) % ring.size()];
    twice += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
  }
  return twice / 2.0;
}

std::vector<CellPolygon> outline(const std::vector<Cell>& cells) {
  const std::set<Cell> all(cells.begin(), cells.end());
  Sides sides;
  for (const Cell& cell : all) {
    const auto [x, y] = cell;
    if (!all.contains({x, y - 1})) sides[{y, x}].push_back({1, 0});
    if (!all.contains({x + 1, y})) sides[{y, x + 1}].push_back({0, 1});
    if (!all.contains({x, y + 1})) sides[{y + 1, x + 1}].push_back({-1, 0});
    if (!all.contains({x - 1, y})) sides[{y + 1, x}].push_back({0, -1});
  }
  std::vector<CellPolygon> polygons;
  std::vector<CellRing> holes;
  while (!sides.empty()) {
    CellRing ring = take_ring(sides);
    if (signed_area(ring) > 0.0) {
      polygons.push_back({std::move(ring), {}});
    } else {
      holes.push_back(std::move(ring));
    }
  }
  for (CellRing& hole : holes) {
    // Right above its lowest corner lies the hole itself; of the rings around it the smallest.
    const Cell inside = *std::min_element(
        hole.begin(), hole.end(),
        [](const Cell& a, const Cell& b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
    CellPolygon* around = nullptr;
    for (CellPolygon& polygon : polygons) {
      if (!holds(polygon.outer, inside)) continue;
      if (around == nullptr || signed_area(polygon.outer) < signed_area(around->outer)) {
        around = &polygon;
      }
    }
    around->holes.push_back(std::move(hole));
  }
  return polygons;
}

}  // namespace strata
