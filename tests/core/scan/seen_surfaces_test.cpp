// SPDX-License-Identifier: Apache-2.0
#include "core/scan/seen_surfaces.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"

namespace strata {
namespace {

constexpr float kNoReturn = std::numeric_limits<float>::infinity();
constexpr std::size_t kBeams = 181;
constexpr std::size_t kAhead = 90;

/// A wall at x = 3 as beams of one degree see it from the origin, ahead is beam 90.
Scan wall_ahead() {
  Scan scan;
  scan.angle_min_rad = static_cast<float>(degrees_to_radians(-90.0));
  scan.angle_increment_rad = static_cast<float>(degrees_to_radians(1.0));
  scan.range_max_m = 8.0F;
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    const double range = 3.0 / std::max(1e-3, std::cos(scan.bearing_rad(beam)));
    scan.ranges_m.push_back(range < 8.0 ? static_cast<float>(range) : kNoReturn);
  }
  return scan;
}

SeenSurfaces seen(const Scan& scan, const Pose2& laser_from_other, const Scan& other) {
  SeenSurfaces surfaces;
  surfaces.lay(scan, laser_from_other, other);
  return surfaces;
}

TEST(SeenSurfaces, AreWhereTheBeamsOfAnotherPlaceMeetThem) {
  const Scan scan = wall_ahead();
  // The other scan was taken a metre further back, to the side, and turned.
  const Pose2 other{-1.0, 0.4, 0.2};
  Scan from_there = scan;
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    const double angle = other.theta + scan.bearing_rad(beam);
    const double range = 4.0 / std::max(1e-3, std::cos(angle));
    from_there.ranges_m[beam] = range < 8.0 ? static_cast<float>(range) : kNoReturn;
  }
  const SeenSurfaces surfaces = seen(scan, other, from_there);
  for (std::size_t beam = kAhead - 40; beam <= kAhead + 40; ++beam) {
    EXPECT_NEAR(surfaces.range_m(beam), 3.0 / std::cos(scan.bearing_rad(beam)), 1e-4) << beam;
  }
}

TEST(SeenSurfaces, GoOnOverTwoBeamsWithoutHitAndNotOverThree) {
  for (const std::size_t missing : {1U, 2U, 3U}) {
    Scan other = wall_ahead();
    for (std::size_t i = 0; i < missing; ++i) other.ranges_m[kAhead + i] = kNoReturn;
    const float range = seen(wall_ahead(), {}, other).range_m(kAhead);
    EXPECT_EQ(range < kNoReturn, missing <= 2) << missing;
  }
}

TEST(SeenSurfaces, DoNotSpanWhatLiesFurtherApartThanASurfaceIsSeen) {
  Scan other = wall_ahead();
  for (std::size_t beam = kAhead; beam < kBeams; ++beam) other.ranges_m[beam] = 1.0F;
  const SeenSurfaces surfaces = seen(wall_ahead(), {}, other);
  EXPECT_EQ(surfaces.range_m(kAhead - 1), kNoReturn) << "an edge";
  EXPECT_EQ(surfaces.range_m(kAhead), kNoReturn) << "an edge";
  EXPECT_NEAR(surfaces.range_m(kAhead - 2), 3.0, 0.01);
  EXPECT_NEAR(surfaces.range_m(kAhead + 1), 1.0, 0.01);
}

TEST(SeenSurfaces, AreNotLaidAcrossTheSeamOfAnglesNorBehindTheBeams) {
  Scan round = wall_ahead();
  round.angle_min_rad = static_cast<float>(degrees_to_radians(-180.0));
  round.angle_increment_rad = static_cast<float>(degrees_to_radians(2.0));
  round.ranges_m.assign(kBeams - 1, 2.0F);
  // From a metre ahead the wall behind lies across the seam.
  const SeenSurfaces surfaces = seen(round, {-1.0, 0.0, 0.0}, round);
  for (std::size_t beam = 1; beam + 2 < kBeams; ++beam) {
    const double bearing = round.bearing_rad(beam);
    const double c = std::cos(bearing);
    const double truth = -c + std::sqrt(c * c + 3.0);
    if (surfaces.range_m(beam) == kNoReturn) {
      EXPECT_TRUE(beam < 3 || beam + 4 > kBeams) << beam;
    } else {
      EXPECT_NEAR(surfaces.range_m(beam), truth, 0.01) << beam;
    }
  }
}

TEST(SeenSurfaces, ThatStayAreThoseOfBothSides) {
  const Scan near = wall_ahead();
  const std::vector<SeenSurfaces> wall{seen(near, {}, near)};
  const std::vector<SeenSurfaces> a_little_further{seen(near, {0.2, 0.0, 0.0}, near)};
  const std::vector<SeenSurfaces> further{seen(near, {0.4, 0.0, 0.0}, near)};
  EXPECT_NEAR(surface_that_stays_m(kAhead, wall, a_little_further), 3.2, 1e-3);
  EXPECT_EQ(surface_that_stays_m(kAhead, wall, further), kNoReturn);
  EXPECT_EQ(surface_that_stays_m(kAhead, wall, {}), kNoReturn);
}

}  // namespace
}  // namespace strata
