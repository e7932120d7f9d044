// SPDX-License-Identifier: Apache-2.0
/// Many cells at once against one after the other.
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/ray_traversal.hpp"
#include "core/random/stream.hpp"
#include "tests/support/every_target.hpp"

namespace strata {
namespace {

struct Visit {
  std::size_t index;
  std::uint64_t length_bits;
  friend bool operator==(const Visit&, const Visit&) = default;
};

using Visits = std::vector<Visit>;

/// A visitor that returns nothing gets many cells at once.
void visit_at_once(const Grid<int>& grid, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                   Visits& visits) {
  visits.clear();
  traverse_ray(grid, from, to, [&](std::size_t index, double length_m) {
    visits.push_back({index, std::bit_cast<std::uint64_t>(length_m)});
  });
}

/// One that could stop is asked cell by cell.
void visit_one_by_one(const Grid<int>& grid, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                      Visits& visits) {
  visits.clear();
  traverse_ray(grid, from, to, [&](std::size_t index, double length_m) {
    visits.push_back({index, std::bit_cast<std::uint64_t>(length_m)});
    return true;
  });
}

/// Anywhere in the grid, or a lattice corner or centre of a cell, or on a line.
Eigen::Vector2d random_point(RandomStream& random, const Grid<int>& grid) {
  const CellRect& rect = grid.rect();
  const auto coordinate = [&](int low, int size) {
    const auto cell = low + 1 + static_cast<int>(random.below(static_cast<unsigned>(size - 2)));
    switch (random.below(4)) {
      case 0:
        return cell * grid.resolution_m();
      case 1:
        return (cell + 0.5) * grid.resolution_m();
      default:
        return (cell + random.uniform(0.0, 1.0)) * grid.resolution_m();
    }
  };
  return {coordinate(rect.min.x, rect.width()), coordinate(rect.min.y, rect.height())};
}

TEST(RayColumns, GiveTheSameCellsAndBitsAsOneByOneOnEveryTarget) {
  for (const double resolution : {0.05, 0.1, 1.0, 0.03}) {
    const Grid<int> grid(resolution, {{-300, -170}, {350, 240}});
    test::for_every_target([&] {
      RandomStream random(1, StreamId::kTest);
      Visits at_once;
      Visits one_by_one;
      for (int n = 0; n < 20'000; ++n) {
        const Eigen::Vector2d from = random_point(random, grid);
        Eigen::Vector2d to = random_point(random, grid);
        if (n % 16 == 0) to.x() = from.x();
        if (n % 16 == 1) to.y() = from.y();
        visit_at_once(grid, from, to, at_once);
        visit_one_by_one(grid, from, to, one_by_one);
        ASSERT_EQ(at_once, one_by_one) << from.transpose() << " to " << to.transpose();
      }
    });
  }
}

TEST(RayColumns, GoOnOneByOneFromACornerFarAlongTheRay) {
  const Grid<int> grid(1.0, {{0, 0}, {2000, 1000}});
  Visits at_once;
  Visits one_by_one;
  for (int corner = 8; corner < 900; corner += 7) {
    // Through the corner (2 corner, corner) and a hair beside it.
    for (const double beside : {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-7, -1e-7}) {
      const Eigen::Vector2d through(2 * corner, corner + beside);
      const Eigen::Vector2d along(1.0, 0.5 - 1e-3 / corner);
      const Eigen::Vector2d from = through - (2 * corner - 0.7) * along;
      const Eigen::Vector2d to = through + (1990.0 - 2 * corner) * along;
      visit_at_once(grid, from, to, at_once);
      visit_one_by_one(grid, from, to, one_by_one);
      ASSERT_EQ(at_once, one_by_one) << corner << ' ' << beside;
    }
  }
}

TEST(RayColumns, AreListedManyAtATimeWhereThereAreFourLanes) {
  test::for_every_target([] {
    // From (0.3, 0.4) 100 cells along x and 30 along y.
    detail::RayColumns ray;
    ray.lines = {0.3, 1.0, 1.0, 1e-2, 0.4, 1.0, 1.0, 1.0 / 30.0, 100, 30, 30.0, 104.4};
    ray.major = 1.0;
    ray.minor = 200.0;
    detail::RayCells cells;
    const bool has_four = hwy::SupportedTargets() <= HWY_AVX2;
    EXPECT_EQ(detail::next_cells(ray, cells), has_four ? 131U : 0U);
  });
}

TEST(RayColumns, LeaveARayThatMeetsACornerToTheCaller) {
  detail::RayColumns ray;
  // The diagonal through all corners.
  ray.lines = {0.5, 1.0, 1.0, 1e-2, 0.5, 1.0, 1.0, 1e-2, 100, 100, 100.0, 141.4};
  detail::RayCells cells;
  EXPECT_EQ(detail::next_cells(ray, cells), 0U);
  EXPECT_EQ(ray.column, 0);
}

}  // namespace
}  // namespace strata
