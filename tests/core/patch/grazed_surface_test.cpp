// SPDX-License-Identifier: Apache-2.0
// A wall seen by one visit, and along which another only looked: nothing has changed.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/contradiction.hpp"

namespace strata::patch {
namespace {

constexpr double kWall_m = 1.025;  // y of a wall along x, the middle of a row of cells
constexpr double kFrom_m = 2.0;    // its ends
constexpr double kTo_m = 2.8;

PosedScan beam(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double stamp_s) {
  PosedScan posed;
  posed.map_from_robot = {from_m.x(), from_m.y(),
                          std::atan2(to_m.y() - from_m.y(), to_m.x() - from_m.x())};
  posed.scan.stamp = Stamp::from_seconds(stamp_s);
  posed.scan.range_max_m = 50.0F;
  posed.scan.angle_increment_rad = 0.01F;
  posed.scan.ranges_m = {static_cast<float>((to_m - from_m).norm())};
  return posed;
}

/// Beams up along the wall's whole length, six a cell, as far as to_m. Cell after cell and again,
/// so that what is seen of neighbouring cells shares time.
void look_up(double to_m, double stamp_s, std::vector<PosedScan>& scans) {
  for (int again = 0; again < 6; ++again) {
    for (double x = kFrom_m + 0.025; x < kTo_m; x += 0.05) {
      scans.push_back(beam({x, 0.0}, {x, to_m}, stamp_s));
    }
  }
}
void look_at_the_wall(double stamp_s, std::vector<PosedScan>& scans) {
  look_up(kWall_m, stamp_s, scans);
}
/// Beams that go across where the wall is.
void look_through_the_wall(double stamp_s, std::vector<PosedScan>& scans) {
  look_up(2.0, stamp_s, scans);
}
/// Beams through the wall's row of cells, along it, that end far behind it. tilt: rise over run.
void look_along_the_wall(double stamp_s, double tilt, std::vector<PosedScan>& scans) {
  for (int i = 0; i < 8; ++i) {
    const double at = 2.4 + 0.01 * i;
    scans.push_back(
        beam({at - 2.0, kWall_m - 2.0 * tilt}, {at + 2.0, kWall_m + 2.0 * tilt}, stamp_s));
  }
}
int contradictory_cells(const std::vector<PosedScan>& scans, const ContradictionConfig& config) {
  VisitTable table = find_visits(scans, 0.05, {}, {});
  table.filter(config.prior);
  const Grid<std::uint8_t> mask = find_contradictions(table, config);
  int count = 0;
  for (const std::uint8_t value : mask.values()) count += value;
  return count;
}

/// The wall in every second visit, a minute apart; `other` in those between.
template <typename Other>
int cells_after(int visits, Other&& other, const ContradictionConfig& config = {}) {
  std::vector<PosedScan> scans;
  for (int v = 0; v < visits; ++v) {
    if (v % 2 == 0) look_at_the_wall(60.0 * v, scans);
    if (v % 2 != 0) other(60.0 * v, scans);
  }
  return contradictory_cells(scans, config);
}

const auto kAlong = [](double stamp_s, std::vector<PosedScan>& scans) {
  look_along_the_wall(stamp_s, 0.004, scans);
};

TEST(GrazedSurface, AWallThatAVisitOnlyLookedAlongHasNotChanged) {
  EXPECT_EQ(cells_after(2, kAlong), 0);
  EXPECT_EQ(cells_after(4, kAlong), 0);
  EXPECT_EQ(cells_after(12, kAlong), 0) << "nor among many visits";
  ContradictionConfig any_beam;
  any_beam.min_across = 0.0;
  EXPECT_GE(cells_after(2, kAlong, any_beam), 8) << "else this world tests nothing";
  EXPECT_GE(cells_after(12, kAlong, any_beam), 8);
}

TEST(GrazedSurface, AWallThatAVisitLookedThroughHas) {
  for (const int visits : {2, 4, 12}) {
    EXPECT_GE(cells_after(visits, look_through_the_wall), 14) << visits << " visits";
  }
}

TEST(GrazedSurface, AWallThatManyVisitsLookedThroughOnceHas) {
  // Less than one beam a visit across each cell, since it comes at an angle of 60 degrees.
  const auto once = [](double stamp_s, std::vector<PosedScan>& scans) {
    for (double x = kFrom_m + 0.025; x < kTo_m; x += 0.05) {
      scans.push_back(beam({x - 0.5, kWall_m - 0.866}, {x + 0.5, kWall_m + 0.866}, stamp_s));
    }
  };
  EXPECT_GE(cells_after(24, once), 14);
}

TEST(GrazedSurface, AWallLookedAlongAndThroughHasChanged) {
  const auto both = [](double stamp_s, std::vector<PosedScan>& scans) {
    look_along_the_wall(stamp_s, 0.004, scans);
    look_through_the_wall(stamp_s + 1.0, scans);
  };
  EXPECT_GE(cells_after(2, both), 14);
  EXPECT_GE(cells_after(12, both), 14);
}

}  // namespace
}  // namespace strata::patch
