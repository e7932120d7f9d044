// SPDX-License-Identifier: Apache-2.0
#include "core/registration/match_field.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "core/registration/scan_matcher.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::registration {
namespace {

TEST(MatchField, GivesTheNearestPointOfEveryCellWithinItsRadius) {
  RandomStream random(7, StreamId::kTest);
  MatchField field(0.05, {.radius_m = 0.4});
  for (int i = 0; i < 60; ++i) {
    SurfacePoint point;
    point.x_m = random.uniform(-2.0, 2.0);
    point.y_m = random.uniform(-2.0, 2.0);
    field.add(point);
  }
  for (int i = 0; i < 20000; ++i) {
    const Cell cell{static_cast<int>(random.below(120)) - 60,
                    static_cast<int>(random.below(120)) - 60};
    const Eigen::Vector2d center = cell_center(cell, 0.05);
    double nearest = std::numeric_limits<double>::infinity();
    for (const SurfacePoint& p : field.points()) {
      nearest = std::min(nearest, std::hypot(p.x_m - center.x(), p.y_m - center.y()));
    }
    if (std::abs(nearest - 0.4) < 1e-4) continue;  // rounding decides at the radius itself
    const SurfacePoint* found = field.nearest(center.x(), center.y());
    ASSERT_EQ(found != nullptr, nearest < 0.4);
    if (found == nullptr) continue;
    ASSERT_NEAR(std::hypot(found->x_m - center.x(), found->y_m - center.y()), nearest, 1e-5);
  }
}

TEST(MatchField, ForgetsWhatIsNoLongerOccupied) {
  MatchField field(0.05);
  SurfacePoint point;
  const std::size_t index = field.add(point);
  EXPECT_NE(field.nearest(0.1, 0.1), nullptr);
  point.occupied = false;
  field.set(index, point);
  EXPECT_EQ(field.nearest(0.1, 0.1), nullptr);
}

TEST(MatchField, TakesTheDirectionOfAWallFromAReflectionGrid) {
  ReflectionGrid map = make_reflection_grid(0.05, {{0, 0}, {40, 40}});
  for (int x = 0; x < 40; ++x) map.at({x, 20}) = 0.9F;
  const MatchField field(map);
  ASSERT_EQ(field.points().size(), 40U);
  const SurfacePoint& middle = field.points()[20];
  EXPECT_NEAR(std::abs(middle.normal_y), 1.0, 1e-9);
  EXPECT_LT(middle.tangential, 0.05);
}

TEST(Surface, NormalsOfASweepFollowTheWallAndAreRoundAtALonePoint) {
  const Scan scan = test::scan_of(test::room(), {5.0, 3.0, 0.3}, 0.0);
  const Endpoints hits = endpoints_in_robot(scan);
  std::vector<SweepSurface> surfaces;
  surfaces_in_sweep(hits, static_cast<double>(scan.angle_increment_rad), surfaces);
  ASSERT_EQ(surfaces.size(), hits.size());
  SurfacePoint point;
  set_surface_direction(point, surfaces[surfaces.size() / 2].normal);
  EXPECT_LT(point.tangential, 0.05);
  Endpoints lone;
  lone.x_m = {3.0};
  lone.y_m = {0.0};
  lone.beam = {0};
  surfaces_in_sweep(lone, 0.01, surfaces);
  set_surface_direction(point, surfaces[0].normal);
  EXPECT_DOUBLE_EQ(point.tangential, 1.0);
}

TEST(Surface, AHitByItselfIsAThingOfItsOwnOnlyWhereTheBeamsBesideItPassNear) {
  Endpoints lone;
  lone.x_m = {3.0};
  lone.y_m = {0.0};
  lone.beam = {7};
  std::vector<SweepSurface> surfaces;
  surfaces_in_sweep(lone, degrees_to_radians(1.0), surfaces);  // 5 cm beside it
  EXPECT_FLOAT_EQ(surfaces[0].normal.xx + surfaces[0].normal.yy, 1.0F);
  surfaces_in_sweep(lone, degrees_to_radians(10.0), surfaces);  // half a metre
  EXPECT_EQ(surfaces[0].normal.xx + surfaces[0].normal.yy, 0.0F);
}

/// Hits of beams one degree apart, beginning at beam `first`; range 0: no return.
Endpoints sweep_of(const std::vector<double>& ranges_m, double first_rad) {
  Endpoints hits;
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    if (ranges_m[i] <= 0.0) continue;
    const double bearing = first_rad + degrees_to_radians(1.0) * static_cast<double>(i);
    hits.x_m.push_back(ranges_m[i] * std::cos(bearing));
    hits.y_m.push_back(ranges_m[i] * std::sin(bearing));
    hits.beam.push_back(static_cast<std::uint32_t>(i));
  }
  return hits;
}

TEST(Surface, AWallSeenAtAGrazingAngleGoesOnBetweenItsHits) {
  // A wall one metre to the left, straight ahead, up to a range of 30 m: gaps of many metres.
  std::vector<double> ranges_m;
  for (int degree = 2; degree < 60; ++degree) {
    ranges_m.push_back(1.0 / std::sin(degrees_to_radians(static_cast<double>(degree))));
  }
  const Endpoints hits = sweep_of(ranges_m, degrees_to_radians(2.0));
  std::vector<SweepSurface> surfaces;
  surfaces_in_sweep(hits, degrees_to_radians(1.0), surfaces);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_GT(surfaces[i].normal.yy, 0.98F) << i;  // across the wall
    const bool last = i == 0 || i + 1 == hits.size();
    const double gap = last ? std::numeric_limits<double>::infinity()
                            : std::max(std::abs(hits.x_m[i] - hits.x_m[i - 1]),
                                       std::abs(hits.x_m[i] - hits.x_m[i + 1]));
    if (last) {
      EXPECT_TRUE(std::isinf(surfaces[i].slack_m)) << i;  // it goes on out of sight
    } else {
      EXPECT_NEAR(static_cast<double>(surfaces[i].slack_m), gap, 1e-4 * gap) << i;
    }
  }
}

TEST(Surface, AGrazedWallGoesOnBesideSomebodyWhoStandsBeforeIt) {
  std::vector<double> ranges_m;
  for (int degree = 2; degree < 30; ++degree) {
    const bool person = degree >= 9 && degree <= 11;
    ranges_m.push_back(person ? 3.0
                              : 1.0 / std::sin(degrees_to_radians(static_cast<double>(degree))));
  }
  std::vector<SweepSurface> surfaces;
  surfaces_in_sweep(sweep_of(ranges_m, degrees_to_radians(2.0)), degrees_to_radians(1.0), surfaces);
  for (const std::size_t beside : {6U, 10U}) {
    EXPECT_GT(surfaces[beside].normal.yy, 0.98F) << beside;
    EXPECT_TRUE(std::isinf(surfaces[beside].slack_m)) << beside;
  }
}

TEST(Surface, AWallEndsWhereTheNextBeamGoesFartherNotWhereSomethingStandsInFront) {
  const auto slack_of_tenth = [](double next_range_m) {
    std::vector<double> ranges_m(10, 0.0);
    for (int i = 0; i < 10; ++i)
      ranges_m[static_cast<std::size_t>(i)] = 2.0 / std::cos(degrees_to_radians(1.0 * i));
    ranges_m.insert(ranges_m.end(), 3, next_range_m);
    std::vector<SweepSurface> surfaces;
    surfaces_in_sweep(sweep_of(ranges_m, 0.0), degrees_to_radians(1.0), surfaces);
    return static_cast<double>(surfaces[9].slack_m);
  };
  EXPECT_LT(slack_of_tenth(6.0), 0.06);          // a doorway: the end lies before the next beam
  EXPECT_TRUE(std::isinf(slack_of_tenth(1.0)));  // a person
  EXPECT_TRUE(std::isinf(slack_of_tenth(0.0)));  // no return
}

}  // namespace
}  // namespace strata::registration
