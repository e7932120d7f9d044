// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/laser.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace strata::simulate {
namespace {

/// A room of 6 x 4 m with its corner at the origin.
const std::vector<Segment>& room() {
  static const std::vector<Segment> kWalls{
      {{0, 0}, {6, 0}}, {{6, 0}, {6, 4}}, {{6, 4}, {0, 4}}, {{0, 4}, {0, 0}}};
  return kWalls;
}

/// The range to the room's walls in closed form.
double range_in_room(double x, double y, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double to_x = c > 0 ? (6 - x) / c : (c < 0 ? -x / c : 1e300);
  const double to_y = s > 0 ? (4 - y) / s : (s < 0 ? -y / s : 1e300);
  return std::min(to_x, to_y);
}

LaserConfig exact_laser() {
  LaserConfig laser;
  laser.noise_m = 0.0;
  laser.drop_probability = 0.0;
  laser.beams = 360;
  laser.field_of_view_deg = 360.0;
  return laser;
}

TEST(Laser, MeasuresARectangleInClosedForm) {
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 50; ++i) {
    const Pose2 pose{random.uniform(0.5, 5.5), random.uniform(0.5, 3.5), random.uniform(-3.0, 3.0)};
    const TrueScan taken = take_scan(exact_laser(), pose, {room(), {}, {}}, random);
    for (std::size_t beam = 0; beam < taken.scan.size(); ++beam) {
      const double expected =
          range_in_room(pose.x, pose.y, pose.theta + taken.scan.bearing_rad(beam));
      ASSERT_NEAR(static_cast<double>(taken.scan.ranges_m[beam]), expected, 2e-6);
      ASSERT_EQ(taken.sources[beam], BeamSource::kStill);
    }
  }
}

TEST(Laser, BeamsLieInTheMiddleOfTheirWedges) {
  RandomStream random(1, StreamId::kTest);
  LaserConfig laser = exact_laser();
  laser.beams = 180;
  laser.field_of_view_deg = 180.0;
  const TrueScan taken = take_scan(laser, {3, 2, 0}, {room(), {}, {}}, random);
  constexpr double kDegree = std::numbers::pi / 180.0;
  EXPECT_NEAR(taken.scan.bearing_rad(0), -89.5 * kDegree, 1e-6);
  EXPECT_NEAR(taken.scan.bearing_rad(179), 89.5 * kDegree, 1e-5);
}

TEST(Laser, NoiseHasTheConfiguredMoments) {
  RandomStream random(2, StreamId::kTest);
  LaserConfig laser = exact_laser();
  laser.noise_m = 0.03;
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (int i = 0; i < 100; ++i) {
    const TrueScan taken = take_scan(laser, {3, 2, 0.3}, {room(), {}, {}}, random);
    for (std::size_t beam = 0; beam < taken.scan.size(); ++beam) {
      const double error = static_cast<double>(taken.scan.ranges_m[beam]) -
                           range_in_room(3, 2, 0.3 + taken.scan.bearing_rad(beam));
      sum += error;
      squares += error * error;
      count += 1.0;
    }
  }
  // Four standard deviations of the two estimates.
  EXPECT_NEAR(sum / count, 0.0, 4.0 * 0.03 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 0.0009, 4.0 * 0.0009 * std::sqrt(2.0 / count));
}

TEST(Laser, DropsAndOutliersHaveTheirShares) {
  RandomStream random(3, StreamId::kTest);
  LaserConfig laser = exact_laser();
  laser.drop_probability = 0.1;
  laser.outlier_probability = 0.2;
  double dropped = 0.0;
  double outliers = 0.0;
  double count = 0.0;
  for (int i = 0; i < 100; ++i) {
    const TrueScan taken = take_scan(laser, {3, 2, 0.3}, {room(), {}, {}}, random);
    for (std::size_t beam = 0; beam < taken.scan.size(); ++beam) {
      const bool is_dropped = taken.scan.kind(beam) == BeamKind::kNoReturn;
      ASSERT_EQ(is_dropped, taken.sources[beam] == BeamSource::kNothing);
      dropped += is_dropped ? 1.0 : 0.0;
      outliers += taken.sources[beam] == BeamSource::kOutlier ? 1.0 : 0.0;
      if (taken.sources[beam] == BeamSource::kOutlier) {
        ASSERT_LE(static_cast<double>(taken.scan.ranges_m[beam]),
                  range_in_room(3, 2, 0.3 + taken.scan.bearing_rad(beam)) + 1e-6);
      }
      count += 1.0;
    }
  }
  EXPECT_NEAR(dropped / count, 0.1, 4.0 * std::sqrt(0.09 / count));
  EXPECT_NEAR(outliers / count, 0.18, 4.0 * std::sqrt(0.18 * 0.82 / count));
}

TEST(Laser, FarWallsAreNoReturnAndNearerThingsHideThem) {
  RandomStream random(4, StreamId::kTest);
  LaserConfig laser = exact_laser();
  laser.range_max_m = 2.5;
  const std::vector<Circle> legs{{{4.0, 2.0}, 0.1}};
  const std::vector<Segment> leaf{{{3.0, 3.0}, {3.0 + 1e-3, 3.0}}, {{2.5, 3.0}, {3.5, 3.0}}};
  const TrueScan taken = take_scan(laser, {3, 2, 0}, {room(), leaf, legs}, random);
  for (std::size_t beam = 0; beam < taken.scan.size(); ++beam) {
    const double angle = taken.scan.bearing_rad(beam);
    const double wall = range_in_room(3, 2, angle);
    if (std::abs(angle) < 0.09) {
      EXPECT_EQ(taken.sources[beam], BeamSource::kPerson);
      EXPECT_LT(taken.scan.ranges_m[beam], 1.0F);
    } else if (std::abs(angle - std::numbers::pi / 2) < 0.4) {
      EXPECT_EQ(taken.sources[beam], BeamSource::kChangeable);
    } else if (wall > 2.5 + 1e-6 && std::abs(angle) > 0.11) {
      EXPECT_EQ(taken.scan.kind(beam), BeamKind::kNoReturn);
    }
  }
}

TEST(Laser, GlassReturnsBeamsNearItsNormalAndLetsOthersPass) {
  RandomStream random(5, StreamId::kTest);
  std::vector<Segment> walls = room();
  walls.push_back({{3.0, 0.0}, {3.0, 4.0}, 0.3});  // a metre before the laser
  const TrueScan taken = take_scan(exact_laser(), {2, 2, 0}, {walls, {}, {}}, random);
  for (std::size_t beam = 0; beam < taken.scan.size(); ++beam) {
    const double angle = taken.scan.bearing_rad(beam);
    const bool is_near = std::abs(angle) < 0.3;
    const double expected = is_near ? 1.0 / std::cos(angle) : range_in_room(2, 2, angle);
    ASSERT_NEAR(static_cast<double>(taken.scan.ranges_m[beam]), expected, 2e-6) << angle;
  }
}

}  // namespace
}  // namespace strata::simulate
