// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/hard_buildings.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "core/random/stream.hpp"
#include "tools/simulate/random_floor.hpp"

namespace strata::experiments {
namespace {

using Point = Eigen::Vector2d;
using simulate::ScenarioConfig;

constexpr double kHalfWidth_m = 1.2;  // of a corridor
constexpr double kRoomDepth_m = 3.5;
constexpr double kDoorway_m = 1.0;
constexpr double kFurnishedShare = 0.2;
constexpr double kOdometryError = 0.05;

void add_wall(ScenarioConfig& building, const Point& a, const Point& b) {
  building.walls.push_back({{a.x(), a.y(), b.x(), b.y()}});
}

void add_block(ScenarioConfig& building, const Point& middle, double half_m) {
  building.blocks.push_back(
      {{middle.x() - half_m, middle.y() - half_m, middle.x() + half_m, middle.y() + half_m}});
}

/// Rooms of about `pitch_m` between a and b, towards `out` (unit), each open by a doorway in its
/// middle.
void add_rooms(ScenarioConfig& building, const Point& a, const Point& b, const Point& out,
               double pitch_m, RandomStream& random) {
  const Point along = (b - a).normalized();
  const auto rooms = static_cast<int>(std::max(1.0, std::floor((b - a).norm() / pitch_m)));
  const double width_m = (b - a).norm() / rooms;
  const auto at = [&](double way_m, double depth_m) -> Point {
    return a + way_m * along + depth_m * out;
  };
  for (int i = 0; i < rooms; ++i) {
    const double from_m = i * width_m;
    const double middle_m = from_m + 0.5 * width_m;
    add_wall(building, at(from_m, 0.0), at(middle_m - 0.5 * kDoorway_m, 0.0));
    add_wall(building, at(middle_m + 0.5 * kDoorway_m, 0.0), at(from_m + width_m, 0.0));
    add_wall(building, at(from_m, 0.0), at(from_m, kRoomDepth_m));
    if (!random.bernoulli(kFurnishedShare)) continue;
    add_block(building, at(middle_m + random.uniform(-0.6, 0.6), random.uniform(1.5, 2.8)),
              random.uniform(0.2, 0.4));
  }
  add_wall(building, b, at((b - a).norm(), kRoomDepth_m));
  add_wall(building, at(0.0, kRoomDepth_m), at((b - a).norm(), kRoomDepth_m));
}

/// One day, and a robot that counts its way 5% wrong.
void equip(ScenarioConfig& building, double reach_m) {
  building.days = 1;
  building.robot.speed_mps = 0.8;
  building.robot.trans_noise = kOdometryError;
  building.robot.rot_noise = kOdometryError;
  building.robot.scale_stddev = kOdometryError;
  building.robot.turn_scale_stddev = kOdometryError;
  building.robot.drift_rad_per_sqrt_m = 0.02;
  building.laser.beams = 270;
  building.laser.field_of_view_deg = 270.0;
  building.laser.range_max_m = reach_m;
  building.laser.noise_m = 0.015;
  building.laser.outlier_probability = 0.002;
}

}  // namespace

ScenarioConfig ring_of_rooms(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kSimulatorWorld, 78'001);
  const Point size(random.uniform(40.0, 70.0), random.uniform(15.0, 30.0));
  const double pitch_m = random.uniform(3.5, 5.0);
  const double w = kHalfWidth_m;
  ScenarioConfig building;
  building.name = "ring_of_rooms";
  building.walls.push_back(
      {{w, w, size.x() - w, w, size.x() - w, size.y() - w, w, size.y() - w, w, w}});
  const Point low(-w, -w);
  const Point high(size.x() + w, size.y() + w);
  add_rooms(building, low, {high.x(), low.y()}, {0.0, -1.0}, pitch_m, random);
  add_rooms(building, {high.x(), low.y()}, high, {1.0, 0.0}, pitch_m, random);
  add_rooms(building, high, {low.x(), high.y()}, {0.0, 1.0}, pitch_m, random);
  add_rooms(building, {low.x(), high.y()}, low, {-1.0, 0.0}, pitch_m, random);
  building.robot.route = {0.0, 0.0, size.x(), 0.0, size.x(), size.y(), 0.0, size.y(), 0.0, 0.0};
  building.robot.laps = 2;
  equip(building, 10.0);
  return building;
}

ScenarioConfig long_corridor(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kSimulatorWorld, 78'002);
  const double length_m = random.uniform(60.0, 110.0);
  const double pitch_m = random.uniform(3.5, 5.0);
  const double w = kHalfWidth_m;
  ScenarioConfig building;
  building.name = "long_corridor";
  add_rooms(building, {-2.0, -w}, {length_m + 2.0, -w}, {0.0, -1.0}, pitch_m, random);
  add_rooms(building, {-2.0, w}, {length_m + 2.0, w}, {0.0, 1.0}, pitch_m, random);
  add_wall(building, {-2.0, -w}, {-2.0, w});
  add_wall(building, {length_m + 2.0, -w}, {length_m + 2.0, w});
  building.robot.route = {0.0, 0.0, length_m, 0.0, 0.0, 0.0};
  equip(building, 10.0);
  return building;
}

ScenarioConfig hall_of_pillars(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kSimulatorWorld, 78'003);
  const Point size(random.uniform(35.0, 60.0), random.uniform(25.0, 40.0));
  const double pitch_m = random.uniform(5.0, 7.0);
  constexpr double kAisle_m = 3.0;  // from a wall, free of pillars
  ScenarioConfig building;
  building.name = "hall_of_pillars";
  building.walls.push_back(
      {{0.0, 0.0, size.x(), 0.0, size.x(), size.y(), 0.0, size.y(), 0.0, 0.0}});
  const double middle_m = 0.5 * size.y();  // the way across
  for (double x = kAisle_m + 1.5; x < size.x() - kAisle_m - 1.0; x += pitch_m) {
    for (double y = kAisle_m + 1.5; y < size.y() - kAisle_m - 1.0; y += pitch_m) {
      if (std::abs(y - middle_m) > 1.2) add_block(building, {x, y}, 0.3);
      const Point stand(x + 0.5 * pitch_m, y + random.uniform(-0.4, 0.4));
      const bool is_clear =
          std::abs(stand.y() - middle_m) > 1.8 && stand.x() < size.x() - kAisle_m - 1.0;
      if (is_clear && random.bernoulli(0.25)) add_block(building, stand, random.uniform(0.3, 0.7));
    }
  }
  const double a = 0.6 * kAisle_m;
  const double right = size.x() - a;
  const double top = size.y() - a;
  building.robot.route = {a,        a, right,    a, right, top,   a,   top,   a, a, right, a, right,
                          middle_m, a, middle_m, a, top,   right, top, right, a, a, a};
  equip(building, 20.0);
  return building;
}

ScenarioConfig poor_odometry_floor(std::uint64_t seed) {
  ScenarioConfig building = simulate::random_floor(seed, {.days = 1});
  equip(building, 8.0);
  return building;
}

}  // namespace strata::experiments
