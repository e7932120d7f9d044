// SPDX-License-Identifier: Apache-2.0
#include "core/grid/metric_polygon.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata {
namespace {

/// A corner on a lattice of quarters, as whole numbers: exact.
struct Corner {
  std::int64_t x = 0;
  std::int64_t y = 0;
};
using Corners = std::vector<Corner>;

/// Where a point (in eighths) lies: -1 on the border, else whether it is inside.
int exact_place(const Corners& ring, const Corner& point) {
  bool inside = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Corner a{2 * ring[i].x, 2 * ring[i].y};
    const Corner& next = ring[(i + 1) % ring.size()];
    const Corner b{2 * next.x, 2 * next.y};
    if ((a.y > point.y) == (b.y > point.y)) continue;
    const std::int64_t side = (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x);
    if (side == 0) return -1;
    if ((side > 0) == (b.y > a.y)) inside = !inside;
  }
  return inside ? 1 : 0;
}

Corners random_ring(RandomStream& stream, int corners) {
  Corners ring;
  for (int i = 0; i < corners; ++i) {
    ring.push_back({static_cast<std::int64_t>(stream.uniform() * 80.0) - 40,
                    static_cast<std::int64_t>(stream.uniform() * 80.0) - 40});
  }
  return ring;
}

MetricRing metric(const Corners& ring) {
  MetricRing result;
  for (const Corner& corner : ring) {
    result.emplace_back(static_cast<double>(corner.x) / 4.0, static_cast<double>(corner.y) / 4.0);
  }
  return result;
}

/// Rings of any shape, crossing themselves and each other, with holes, cut by the rectangle.
TEST(MetricPolygon, CoversTheCellsWhoseMiddleAnExactTestFindsInside) {
  const CellRect rect{{-9, -7}, {11, 9}};
  std::size_t inside = 0;
  std::size_t in_holes = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    RandomStream stream(seed, StreamId::kTest);
    const Corners outer = random_ring(stream, 3 + static_cast<int>(seed % 9));
    std::vector<Corners> holes;
    for (std::uint64_t i = 0; i < seed % 3; ++i) holes.push_back(random_ring(stream, 4));
    MetricPolygon polygon{metric(outer), {}};
    for (const Corners& hole : holes) polygon.holes.push_back(metric(hole));
    const Grid<std::uint8_t> cells = cells_in(polygon, 1.0, rect);
    for (int y = rect.min.y; y < rect.max.y; ++y) {
      for (int x = rect.min.x; x < rect.max.x; ++x) {
        const Corner middle{8 * x + 4, 8 * y + 4};
        int expected = exact_place(outer, middle);
        for (const Corners& hole : holes) {
          const int in_hole = exact_place(hole, middle);
          if (expected == 1 && in_hole != 0) {
            expected = in_hole == 1 ? 0 : -1;
            ++in_holes;
          }
        }
        if (expected < 0) continue;  // on a border: either is right
        inside += expected == 1 ? 1U : 0U;
        EXPECT_EQ(static_cast<int>(cells.get({x, y})), expected) << seed << ": " << x << ", " << y;
        EXPECT_EQ(contains(polygon, cell_center({x, y}, 1.0)), expected == 1) << seed;
      }
    }
  }
  EXPECT_GT(inside, 5000U);
  EXPECT_GT(in_holes, 500U);
}

/// Sets of cells with holes and islands, at resolutions that are no binary fractions.
TEST(MetricPolygon, GivesBackTheCellsThatAnOutlineWasMadeOf) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomStream stream(seed, StreamId::kTest);
    const double resolution_m = std::vector<double>{0.05, 0.1, 0.03, 0.025}[seed % 4];
    const Cell corner{static_cast<int>(stream.uniform() * 2000.0) - 1000,
                      static_cast<int>(stream.uniform() * 2000.0) - 1000};
    const CellRect rect{corner, {corner.x + 14, corner.y + 11}};
    Grid<std::uint8_t> mask(resolution_m, rect, 0);
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (stream.uniform() >= 0.6) continue;
      mask.values()[i] = 1;
      cells.push_back(mask.cell(i));
    }
    Grid<std::uint8_t> again(resolution_m, rect, 0);
    for (const CellPolygon& polygon : outline(cells)) {
      const Grid<std::uint8_t> part =
          cells_in(to_metric(polygon, resolution_m), resolution_m, rect.inflated(3));
      for (std::size_t i = 0; i < part.size(); ++i) {
        if (part.values()[i] == 0) continue;
        ASSERT_TRUE(rect.contains(part.cell(i))) << seed;
        again.at(part.cell(i)) = 1;
      }
    }
    EXPECT_EQ(again.values(), mask.values()) << seed;
  }
}

TEST(MetricPolygon, HasAnAreaWithoutItsHoles) {
  const MetricPolygon square{{{0, 0}, {4, 0}, {4, 3}, {0, 3}}, {{{1, 1}, {1, 2}, {2, 2}, {2, 1}}}};
  EXPECT_DOUBLE_EQ(area_m2(square), 11.0);
  EXPECT_LT(signed_area_m2(square.holes[0]), 0.0);
  EXPECT_EQ(cells_in(square, 0.5, {{-100, -100}, {-90, -90}}).size(), 0U) << "elsewhere";
}

}  // namespace
}  // namespace strata
